!> Order of the integrator and of its dense output, on q'' = -w^2 q with friction-free closed form.
module pendulum_case
   use common_kinds, only : wp
   use common_dopri5, only : oscillator
   implicit none
   private
   public :: linear_oscillator, frequency
   real(wp), parameter :: frequency = 2.385_wp
   type, extends(oscillator) :: linear_oscillator
   contains
      procedure :: acceleration
   end type linear_oscillator
contains
   function acceleration(system, t, q, v) result(a)
      class(linear_oscillator), intent(in) :: system
      real(wp), intent(in) :: t, q, v
      real(wp) :: a
      a = -frequency**2 * q + 0.0_wp * (t + v)
      if (.false. .and. same_type_as(system, system)) a = 0.0_wp
   end function acceleration
end module pendulum_case

program test_dopri5
   use common_kinds, only : wp
   use common_dense_step, only : dense_step
   use common_dopri5, only : dopri5_attempt, dopri5_factor, step_memory
   use pendulum_case, only : linear_oscillator, frequency
   implicit none (type, external)
   real(wp) :: error(2), dense_error(2), order
   integer :: i

   do i = 1, 2
      call run(16 * i, error(i), dense_error(i))
   end do
   order = log(error(1) / error(2)) / log(2.0_wp)
   print '(a, f6.3)', 'order of the step      ', order
   if (abs(order - 5.0_wp) > 0.2_wp) error stop 'the integrator is not of order 5'
   order = log(dense_error(1) / dense_error(2)) / log(2.0_wp)
   print '(a, f6.3)', 'order of dense output  ', order
   if (order < 3.8_wp) error stop 'the dense output is not of order 4'
   call check_control()

contains

   !> The PI controller (Hairer, Norsett and Wanner 1993, II.4 and IV.2): 0.9 before^0.04 / error^0.17 after an accepted
   !> step, within 0.2 to 5; 0.9 / error^0.17 after a refused one, not below 0.1; no longer step right after that
   subroutine check_control()
      use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
      type(step_memory) :: memory
      real(wp) :: factor
      call dopri5_factor(0.37_wp, memory, factor)
      call near(factor, 0.9_wp * 1.0e-4_wp**0.04_wp / 0.37_wp**0.17_wp)
      if (memory%rejected) error stop 'an accepted step is remembered as refused'
      call dopri5_factor(0.61_wp, memory, factor)
      call near(factor, 0.9_wp * 0.37_wp**0.04_wp / 0.61_wp**0.17_wp)
      call dopri5_factor(7.3_wp, memory, factor)
      call near(factor, 0.9_wp / 7.3_wp**0.17_wp)
      if (.not. memory%rejected) error stop 'a refused step is forgotten'
      call dopri5_factor(1.0e-9_wp, memory, factor)
      call near(factor, 1.0_wp)
      call dopri5_factor(1.0e-9_wp, memory, factor)
      call near(factor, 5.0_wp)
      call dopri5_factor(1.0e9_wp, memory, factor)
      call near(factor, 0.1_wp)
      call dopri5_factor(ieee_value(factor, ieee_quiet_nan), memory, factor)
      call near(factor, 0.1_wp)
   end subroutine check_control

   subroutine near(found, expected)
      real(wp), intent(in) :: found
      real(wp), intent(in) :: expected
      if (abs(found - expected) > 1.0e-12_wp * expected) error stop 'the step control is not that of the book'
   end subroutine near

   subroutine run(steps, error_end, error_dense)
      integer, intent(in) :: steps
      real(wp), intent(out) :: error_end, error_dense
      type(linear_oscillator) :: problem
      type(dense_step) :: step
      real(wp) :: t, h, q, v, a, s
      integer :: k, j

      h = 1.7_wp / real(steps, wp)
      t = 0.0_wp
      q = 0.37_wp
      v = -0.61_wp
      a = problem%acceleration(t, q, v)
      error_dense = 0.0_wp
      do k = 1, steps
         call dopri5_attempt(problem, t, h, q, v, a, 1.0_wp, 1.0_wp, 1.0_wp, step)
         do j = 1, 9
            s = 0.1_wp * real(j, wp)
            error_dense = max(error_dense, abs(step%coordinate(s) - exact(t + s * h)))
         end do
         t = t + h
         q = step%q
         v = step%v
         a = step%a
      end do
      error_end = hypot(q - exact(t), v / frequency - exact_rate(t) / frequency)
   end subroutine run

   function exact_rate(t) result(v)
      real(wp), intent(in) :: t
      real(wp) :: v
      v = -0.37_wp * frequency * sin(frequency * t) - 0.61_wp * cos(frequency * t)
   end function exact_rate

   function exact(t) result(q)
      real(wp), intent(in) :: t
      real(wp) :: q
      q = 0.37_wp * cos(frequency * t) - 0.61_wp / frequency * sin(frequency * t)
   end function exact

end program test_dopri5
