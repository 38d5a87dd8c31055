!> The coaxial law of a point: its matrix is the derivative of its stress, which is that of its energy; the energy is
!> convex with frozen damage; one strain alone follows the softening law, whose energy is lost
program test_sla_coaxial
   use common_kinds, only : wp
   use common_lists, only : law_exponential => sla_law_exponential, law_hordijk => sla_law_hordijk, &
      law_linear => sla_law_linear
   use common_status, only : status_ok
   use sla_coaxial, only : by_frozen, by_secant, by_tangent, coaxial_law, coaxial_response, coaxial_state
   use sla_sawtooth, only : softening, softening_new
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none (type, external)
   real(wp), parameter :: young = 1.7e9_wp, floor = 1.0e-6_wp
   integer(c_int), parameter :: laws(3) = [law_linear, law_exponential, law_hordijk]
   integer :: i, j

   call random_seed(put=[(17 + 3 * i, i=1, 64)])
   do i = 1, 3
      call follow(laws(i))
      do j = 0, 3
         call differentiate(laws(i), 0.1_wp * real(j, wp))
      end do
   end do

contains

   !> Masonry that cracks at 0.1 MPa and crushes at 3 MPa
   function masonry(kind, nu) result(law)
      integer(c_int), intent(in) :: kind
      real(wp), intent(in) :: nu
      type(coaxial_law) :: law
      integer(c_int) :: status
      law%young = young
      law%nu = nu
      law%floor = floor
      law%cracks = .true.
      law%crushes = .true.
      call softening_new(kind, young, 1.0e5_wp, 50.0_wp, 0.1_wp, law%tension, status)
      if (status /= status_ok) error stop 'no law of tension'
      call softening_new(law_exponential, young, 3.0e6_wp, 5.0e3_wp, 0.1_wp, law%compression, status)
      if (status /= status_ok) error stop 'no law of compression'
   end function masonry

   !> A bar torn in small steps: the work of its stress is stored and lost, and in the end Gf / h
   subroutine follow(kind)
      integer(c_int), intent(in) :: kind
      integer, parameter :: steps = 40000
      type(coaxial_law) :: law
      type(coaxial_state) :: state
      real(wp) :: strain, before, work, lost(2)
      integer :: k
      law = masonry(kind, 0.0_wp)
      work = 0.0_wp
      before = 0.0_wp
      do k = 1, steps
         strain = 4.0e-2_wp * real(k, wp) / real(steps, wp)
         call coaxial_response(law, [strain, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], by_tangent, state)
         work = work + 0.5_wp * (before + state%sigma(1)) * 4.0e-2_wp / real(steps, wp)
         before = state%sigma(1)
         if (abs(state%history(1) - strain) > 1.0e-9_wp * strain) error stop 'the history is not the strain'
         if (mod(k, 2000) /= 0) cycle
         lost = law%lost_energy(state%history)
         if (abs(work - state%energy - lost(1)) > 2.0e-3_wp * work) error stop 'work is neither stored nor lost'
         if (abs(law%tension%strain_at(law%tension%secant(strain)) - strain) > 1.0e-6_wp * strain .and. &
             law%tension%secant(strain) > 0.0_wp) error stop 'the strain of a secant modulus is another'
      end do
      if (abs(work - 500.0_wp) > 0.02_wp * 500.0_wp) error stop 'the energy is not Gf / h'
   end subroutine follow

   !> Random strains and histories
   subroutine differentiate(kind, nu)
      integer(c_int), intent(in) :: kind
      real(wp), intent(in) :: nu
      real(wp), parameter :: step = 1.0e-5_wp
      type(coaxial_law) :: law
      type(coaxial_state) :: state, up, down, other
      real(wp) :: eps(3), far(3), history(2), random(8), h, column(3)
      integer :: trial, k, how
      law = masonry(kind, nu)
      do trial = 1, 2000
         call random_number(random)
         eps = 2.0e-3_wp * (random(1:3) - 0.5_wp)
         far = 2.0e-3_wp * (random(4:6) - 0.5_wp)
         history = [1.0e-3_wp, 4.0e-3_wp] * random(7:8)
         call coaxial_response(law, eps, history, by_frozen, state)
         call coaxial_response(law, far, history, by_frozen, other)
         if (dot_product(state%sigma - other%sigma, eps - far) < -1.0e-9_wp * norm2(state%sigma) * norm2(eps)) then
           error stop 'the frozen energy is not convex'
         end if
         h = step * maxval(abs(eps))
         do how = by_tangent, by_frozen
            if (how == by_secant) cycle
            call coaxial_response(law, eps, history, how, state)
            ! The tangent leaves out what one direction in tension does to the damage of the other
            if (how == by_tangent .and. state%shared > 0.0_wp) cycle
            do k = 1, 3
               call coaxial_response(law, moved(eps, k, h), history, how, up)
               call coaxial_response(law, moved(eps, k, -h), history, how, down)
               if (any((up%principal > 0.0_wp) .neqv. (down%principal > 0.0_wp))) cycle
               if (any((up%history > history) .neqv. (down%history > history))) cycle
               column = (up%sigma - down%sigma) / (2.0_wp * h)
               if (norm2(column - state%matrix(:, k)) > 1.0e-3_wp * maxval(abs(state%matrix))) then
                 error stop 'the matrix is not the derivative of the stress'
               end if
               if (how == by_frozen) then
                  if (abs(0.5_wp * (up%energy - down%energy) / h - state%sigma(k)) > 1.0e-4_wp * norm2(state%sigma)) &
                     then
                    error stop 'the stress is not the derivative of the energy'
                  end if
               end if
            end do
         end do
      end do
   end subroutine differentiate

   pure function moved(eps, k, h) result(there)
      real(wp), intent(in) :: eps(3)
      integer, intent(in) :: k
      real(wp), intent(in) :: h
      real(wp) :: there(3)
      there = eps
      there(k) = there(k) + h
   end function moved

end program test_sla_coaxial
