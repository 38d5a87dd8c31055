!> Derivatives of the mechanism against differences of its energies, and refusal of bad hinges.
program test_four_hinge
   use common_kinds, only : wp, gravity
   use common_status, only : status_ok
   use arch_four_hinge, only : four_hinge, four_hinge_new
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none (type, external)
   type(four_hinge) :: mechanism
   integer(c_int) :: status
   real(wp) :: m, half_dm, dv, dh, m_low, m_high, dummy(3), q
   real(wp), parameter :: step = 1.0e-5_wp
   logical :: closed

   ! Oppenheim's arch, links lumped at plausible places with distinct numbers
   call four_hinge_new(reshape([-9.07_wp, 1.80_wp, -5.97_wp, 8.94_wp, 2.1_wp, 10.54_wp, 10.54_wp, 2.10_wp], [2, 4]), &
      [11.3_wp, 12.1_wp, 17.9_wp], reshape([-8.3_wp, 5.6_wp, -2.1_wp, 9.7_wp, 7.4_wp, 6.9_wp], [2, 3]), &
      [31.0_wp, 43.0_wp, 59.0_wp], mechanism, status)
   if (status /= status_ok) error stop 'a sound mechanism was refused'
   q = 0.083_wp
   call mechanism%coefficients(q, m, half_dm, dv, dh, closed)
   call mechanism%coefficients(q - step, m_low, dummy(1), dummy(2), dummy(3), closed)
   call mechanism%coefficients(q + step, m_high, dummy(1), dummy(2), dummy(3), closed)
   call near(half_dm, 0.25_wp * (m_high - m_low) / step, 'M''/2')
   call near(dv, (mechanism%potential(q + step) - mechanism%potential(q - step)) / (2.0_wp * step), 'V''')
   if (.not. mechanism%critical < mechanism%lock) error stop 'critical rotation past the lock'
   call mechanism%coefficients(mechanism%critical, m, half_dm, dv, dh, closed)
   call near(dv / (gravity * 11.3_wp), 0.0_wp, 'V'' at the critical rotation')

   ! All hinges on one line make no mechanism
   call four_hinge_new(reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], [2, 4]), &
      [1.1_wp, 1.2_wp, 1.3_wp], reshape([0.5_wp, 0.1_wp, 1.5_wp, 0.1_wp, 2.5_wp, 0.1_wp], [2, 3]), &
      [0.1_wp, 0.2_wp, 0.3_wp], mechanism, status)
   if (status == status_ok) error stop 'hinges on a line were accepted'

contains

   subroutine near(value, reference, name)
      real(wp), intent(in) :: value, reference
      character(len=*), intent(in) :: name
      print '(a, 2es16.8)', name, value, reference
      if (abs(value - reference) > 1.0e-7_wp * max(1.0_wp, abs(reference))) error stop 'derivative is wrong'
   end subroutine near

end program test_four_hinge
