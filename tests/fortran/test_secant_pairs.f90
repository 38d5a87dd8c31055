!> Pairs of changes on a quadratic potential: the last pair is met exactly, and a search that ends each way at its least
!> potential finds the minimum of four unknowns in four ways, from the unit matrix
program test_secant_pairs
   use common_kinds, only : wp
   use common_status, only : status_ok
   use sla_secant_pairs, only : pair_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none (type, external)
   integer, parameter :: n = 4
   real(wp) :: k(n, n), u(n), force(n), before(n), z(n), lambda, part
   type(pair_memory) :: pairs
   integer(c_int) :: status
   integer :: i

   k = reshape([4.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 3.0_wp, 0.5_wp, 0.0_wp, 0.0_wp, 0.5_wp, 2.0_wp, 0.1_wp, &
      0.0_wp, 0.0_wp, 0.1_wp, 0.05_wp], [n, n])
   u = [1.0_wp, -2.0_wp, 0.5_wp, 3.0_wp]
   call pairs%make(n, status)
   if (status /= status_ok) error stop 'no memory'
   force = matmul(k, u)
   do i = 1, n
      before = force
      call pairs%reduce(force)
      z = -force
      lambda = 0.0_wp
      call pairs%complete(z, lambda)
      if (.not. dot_product(before, z) < 0.0_wp) error stop 'a way upward'
      part = -dot_product(before, z) / dot_product(z, matmul(k, z))
      u = u + part * z
      force = matmul(k, u)
      call pairs%take(part * z, part, force - before, part * dot_product(before, z))
      if (pairs%count /= i) error stop 'a pair of positive work is not taken'
      ! The secant equation: the direction of the change of forces is the change of displacements, and its multiplier's
      before = force - before
      call pairs%reduce(before)
      z = -before
      lambda = 0.0_wp
      call pairs%complete(z, lambda)
      if (maxval(abs(z + pairs%moved(:, i))) > 1.0e-9_wp * maxval(abs(pairs%moved(:, i)))) error stop 'the last pair is not met'
      if (abs(lambda + part) > 1.0e-9_wp * part) error stop 'the multiplier of the last pair is not met'
   end do
   if (maxval(abs(u)) > 1.0e-10_wp) error stop 'no minimum after as many ways as unknowns'
   ! Along negative stiffness nothing is learnt
   call pairs%take(z, 0.0_wp, -z, 1.0_wp)
   if (pairs%count /= n) error stop 'a pair of negative work is taken'
end program test_secant_pairs
