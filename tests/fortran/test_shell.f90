!> Flat shells without Python: layers, rigid motions, and patch tests of distorted elements in a tilted plane.
program test_shell
   use common_kinds, only : wp
   use common_lists, only : element_q4 => sla_element_q4, element_t3 => sla_element_t3, &
      gauss => shell_through_gauss, lobatto => shell_through_lobatto
   use common_status, only : status_ok
   use shell_group, only : shell_points, shell_points_new, shell_section
   use shell_layers, only : layers_new, most_layers
   use sla_group, only : material_options
   use sla_tables, only : tooth_tables
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none (type, external)
   !> MacNeal and Harder's patch (1985): four corners, four nodes within
   integer, parameter :: nodes = 8, outer = 4
   real(wp), parameter :: plan(2, nodes) = reshape([0.0_wp, 0.0_wp, 0.24_wp, 0.0_wp, 0.24_wp, 0.12_wp, 0.0_wp, &
      0.12_wp, 0.04_wp, 0.02_wp, 0.18_wp, 0.03_wp, 0.16_wp, 0.08_wp, 0.08_wp, 0.08_wp], [2, nodes])
   integer(c_int), parameter :: quads(4, 5) = reshape([1, 2, 6, 5, 2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8, 5, 6, 7, 8], &
      [4, 5])
   real(wp), parameter :: thickness = 0.01_wp, young = 1.0e6_wp, nu = 0.25_wp
   integer(c_int) :: triangles(3, 10)
   real(wp) :: axes(3, 3)
   integer :: i

   ! Rows: x is horizontal and y goes up, as the elements have them
   axes(3, :) = [0.48_wp, -0.64_wp, 0.6_wp]
   axes(1, :) = [0.64_wp, 0.48_wp, 0.0_wp] / 0.8_wp
   axes(2, :) = [axes(3, 2) * axes(1, 3) - axes(3, 3) * axes(1, 2), axes(3, 3) * axes(1, 1) - axes(3, 1) * axes(1, 3), &
      axes(3, 1) * axes(1, 2) - axes(3, 2) * axes(1, 1)]
   do i = 1, 5
      triangles(:, 2 * i - 1) = quads([1, 2, 3], i)
      triangles(:, 2 * i) = quads([1, 3, 4], i)
   end do
   call thickness_rules()
   call patches(element_q4, quads)
   call patches(element_t3, triangles)
   call warped()

contains

   !> Both rules are exact for the polynomials they promise
   subroutine thickness_rules()
      real(wp) :: height(most_layers), share(most_layers), exact
      integer(c_int) :: n, status
      integer :: power
      do n = 1, most_layers
         call layers_new(gauss, n, height, share, status)
         if (status /= status_ok) error stop 'no layers of Gauss'
         do power = 0, 2 * int(n) - 1
            exact = 0.0_wp
            if (mod(power, 2) == 0) exact = 0.5_wp**power / real(power + 1, wp)
            if (abs(sum(share(1:n) * height(1:n)**power) - exact) > 1.0e-14_wp) error stop 'Gauss is inexact'
         end do
         if (n < 2) cycle
         call layers_new(lobatto, n, height, share, status)
         if (status /= status_ok) error stop 'no layers of Lobatto'
         if (abs(height(1) + 0.5_wp) + abs(height(n) - 0.5_wp) > 1.0e-15_wp) error stop 'Lobatto has no layers on faces'
         do power = 0, 2 * int(n) - 3
            exact = 0.0_wp
            if (mod(power, 2) == 0) exact = 0.5_wp**power / real(power + 1, wp)
            if (abs(sum(share(1:n) * height(1:n)**power) - exact) > 1.0e-14_wp) error stop 'Lobatto is inexact'
         end do
      end do
      call layers_new(lobatto, 1_c_int, height, share, status)
      if (status == status_ok) error stop 'one layer on two faces'
   end subroutine thickness_rules

   !> Elements on some nodes, two layers, elastic
   subroutine elastic(kind, xyz, connect, flat, group)
      integer(c_int), intent(in) :: kind
      real(wp), intent(in) :: xyz(:, :)
      integer(c_int), intent(in) :: connect(:, :)
      integer(c_int), intent(in) :: flat
      type(shell_points), intent(out) :: group
      type(tooth_tables) :: teeth
      type(material_options) :: options
      real(wp) :: property(14, size(connect, 2)), frame(3, 3, size(xyz, 2))
      integer(c_int) :: choice(5, size(connect, 2)), every(size(xyz, 2)), bad, status
      integer :: e, k, j
      property = 0.0_wp
      property(1, :) = thickness
      property(2, :) = young
      property(3, :) = nu
      choice = 0
      every = flat
      do k = 1, size(xyz, 2)
         frame(:, :, k) = 0.0_wp
         do j = 1, 3
            frame(j, j, k) = 1.0_wp
         end do
         if (flat == 1) frame(:, :, k) = transpose(axes)
      end do
      call shell_points_new(kind, shell_section(gauss, 2_c_int, .true.), .false., xyz, frame, every, connect, &
         property, choice, teeth, options, group, bad, status)
      if (status /= status_ok) error stop 'no shells'
      allocate (group%equation(group%freedoms, group%elements), group%factor(group%freedoms, group%elements))
      group%factor = 1.0_wp
      do e = 1, group%elements
         do k = 1, size(connect, 1)
            do j = 1, 6
               group%equation(6 * (k - 1) + j, e) = 6_c_int * (connect(k, e) - 1_c_int) + int(j, c_int)
            end do
         end do
      end do
   end subroutine elastic

   !> Uniform strain, curvature and twist are met exactly by all points, and the nodes within are in equilibrium
   subroutine patches(kind, connect)
      integer(c_int), intent(in) :: kind
      integer(c_int), intent(in) :: connect(:, :)
      type(shell_points) :: group
      real(wp) :: xyz(3, nodes), u(0:6 * nodes), f(0:6 * nodes), own(6), eps(3, 60), wanted(3), local(24)
      integer :: which, n, e, p
      integer(c_int) :: flat
      do n = 1, nodes
         xyz(:, n) = matmul([plan(1, n), plan(2, n), 0.0_wp], axes)
      end do
      do flat = 0, 1
         call elastic(kind, xyz, connect, flat, group)
         do which = 1, 6
            u = 0.0_wp
            do n = 1, nodes
               own = field(which, plan(1, n), plan(2, n))
               u(6 * n - 5:6 * n - 3) = matmul(own(1:3), axes)
               u(6 * n - 2:6 * n) = own(4:6)
               if (flat == 0) u(6 * n - 2:6 * n) = matmul(own(4:6), axes)
            end do
            f = 0.0_wp
            call group%force(u, f)
            if (maxval(abs(f(6 * outer + 1:))) > 1.0e-10_wp * maxval(abs(f))) error stop 'a patch test fails'
            do e = 1, group%elements
               call group%gather(e, u, local)
               call group%strains(e, local, eps)
               do p = 1, group%per
                  wanted = strain_of(which, thickness * group%height(1 + mod(p - 1, 2)))
                  if (maxval(abs(eps(:, p) - wanted)) > 1.0e-14_wp) error stop 'a point is strained otherwise'
               end do
            end do
         end do
      end do
      print '(a, i0, a)', 'patch tests of ', kind, ' nodes: membrane, bending, twist'
   end subroutine patches

   !> Displacements and rotations in the plane's axes: three uniform strains, two curvatures, twist
   pure function field(which, x, y) result(own)
      integer, intent(in) :: which
      real(wp), intent(in) :: x, y
      real(wp) :: own(6)
      own = 0.0_wp
      select case (which)
      case (1)
         own(1) = 1.0e-3_wp * x
      case (2)
         own(2) = 1.0e-3_wp * y
      case (3)
         own(1) = 1.0e-3_wp * y
         own(6) = -0.5e-3_wp
      case (4)
         own(3) = 0.5_wp * x**2
         own(5) = -x
      case (5)
         own(3) = 0.5_wp * y**2
         own(4) = y
      case default
         own(3) = 0.5_wp * x * y
         own(4) = 0.5_wp * x
         own(5) = -0.5_wp * y
      end select
   end function field

   !> Strains of that field at a height
   pure function strain_of(which, z) result(eps)
      integer, intent(in) :: which
      real(wp), intent(in) :: z
      real(wp) :: eps(3)
      eps = 0.0_wp
      if (which <= 3) eps(which) = 1.0e-3_wp
      if (which > 3) eps(which - 3) = -z
   end function strain_of

   !> A twisted quadrilateral has no forces under the six rigid motions, and its matrix gives its forces
   subroutine warped()
      type(shell_points) :: group
      real(wp) :: xyz(3, 4), u(0:24), f(0:24), k(24, 24), turn(3)
      integer :: which, n
      xyz = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.1_wp, 0.2_wp, 1.2_wp, 0.9_wp, -0.1_wp, 0.1_wp, 1.0_wp, &
         0.3_wp], [3, 4])
      call elastic(element_q4, xyz, reshape([1_c_int, 2_c_int, 3_c_int, 4_c_int], [4, 1]), 0_c_int, group)
      call group%matrix(1, k)
      if (maxval(abs(k - transpose(k))) > 1.0e-12_wp * maxval(abs(k))) error stop 'the matrix is not symmetric'
      do which = 1, 6
         u = 0.0_wp
         do n = 1, 4
            if (which <= 3) u(6 * (n - 1) + which) = 1.0_wp
            if (which <= 3) cycle
            turn = 0.0_wp
            turn(max(which - 3, 1)) = 1.0_wp
            u(6 * n - 2:6 * n) = turn
            u(6 * n - 5:6 * n - 3) = [turn(2) * xyz(3, n) - turn(3) * xyz(2, n), turn(3) * xyz(1, n) - &
               turn(1) * xyz(3, n), turn(1) * xyz(2, n) - turn(2) * xyz(1, n)]
         end do
         f = 0.0_wp
         call group%force(u, f)
         if (maxval(abs(f)) > 1.0e-11_wp * maxval(abs(k))) error stop 'a rigid motion has forces'
      end do
      u = [(sin(real(n, wp)), n=0, 24)]
      f = 0.0_wp
      call group%force(u, f)
      if (maxval(abs(matmul(k, u(1:)) - f(1:))) > 1.0e-12_wp * maxval(abs(f))) error stop 'matrix and forces differ'
   end subroutine warped

end program test_shell
