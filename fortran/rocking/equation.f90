!> The equation of motion of a rocking structure on one side, and one step of it.
module rocking_equation
   use common_dense_step, only : dense_step
   use common_dopri5, only : oscillator, dopri5_attempt
   use common_kinds, only : wp, gravity
   use common_signal, only : signal
   use rocking_restraint, only : restraint_state
   use rocking_rocker, only : rocker, series_short, side_index
   implicit none
   private
   public :: equation_of_motion, attempt_step, series_factor, polish_impact

   !> Equation of motion on one side during one segment of the ground motion
   type, extends(oscillator) :: equation_of_motion
      class(rocker), pointer :: body => null()
      type(signal) :: ground
      integer :: segment = 0
      integer :: side = 1
      logical :: series = .false.  !! the structure solves its own steps
      real(wp) :: rest_dv(2) = 0.0_wp  !! V' at rest, both sides
      real(wp) :: rest_dh(2) = 0.0_wp  !! H at rest, both sides
      real(wp) :: rest_hold(2) = 0.0_wp  !! moment of restraints at rest, both sides [N m]
      type(restraint_state), allocatable :: memory(:)  !! of the restraints; not allocated where there are none
   contains
      procedure :: acceleration
   end type equation_of_motion

contains

   function acceleration(system, t, q, v) result(a)
      class(equation_of_motion), intent(in) :: system
      real(wp), intent(in) :: t
      real(wp), intent(in) :: q
      real(wp), intent(in) :: v
      real(wp) :: a
      real(wp) :: m, half_dm, dv, dh, horizontal, vertical
      logical :: closed

      call system%body%coefficients(system%side, q, m, half_dm, dv, dh, closed)
      if (.not. closed) then
         a = huge(a)  ! the error test refuses the step
         return
      end if
      call system%ground%value_at(system%segment, t, horizontal, vertical)
      a = -(half_dm * v * v + dv * (1.0_wp + vertical / gravity) + real(system%side, wp) * horizontal * dh) / m
      if (allocated(system%memory)) then
         a = a - system%body%held%moment(side_index(system%side), q, v, system%memory) / m
      end if
   end function acceleration

   !> One step: by the structure's own series where it has one and the ground runs in straight lines
   subroutine attempt_step(problem, t, h, q, v, a, atol_q, atol_v, rtol, step)
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: t, h, q, v, a   !! start time, length, and state at the start
      real(wp), intent(in) :: atol_q, atol_v  !! absolute tolerances
      real(wp), intent(in) :: rtol
      type(dense_step), intent(inout) :: step
      real(wp) :: value(2), slope(2)

      if (problem%series) then
         call problem%ground%line_at(problem%segment, t, value, slope)
         step%t = t
         call problem%body%series_step(problem%side, h, q, v, value, slope, [atol_q, atol_v, rtol], step)
      else
         call dopri5_attempt(problem, t, h, q, v, a, atol_q, atol_v, rtol, step)
      end if
   end subroutine attempt_step

   !> Factor for the next step length after a series: its error grows with the power of the last term
   pure function series_factor(step) result(factor)
      type(dense_step), intent(in) :: step
      real(wp) :: factor
      if (.not. step%error <= huge(1.0_wp)) then
         factor = 0.1_wp
      else if (step%error <= series_short) then
         factor = 2.0_wp
      else
         factor = min(2.0_wp, max(0.1_wp, 0.9_wp * step%error**(-1.0_wp / real(step%degree - 2, wp))))
      end if
   end function series_factor

   !> Repeat the step with its end on the impact: the time then has the order of the integrator
   subroutine polish_impact(problem, q, v, a, atol_q, atol_v, rtol, fraction, step)
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: q, v, a         !! state at the start of the step
      real(wp), intent(in) :: atol_q, atol_v  !! absolute tolerances
      real(wp), intent(in) :: rtol
      real(wp), intent(in) :: fraction        !! first guess, of the step
      type(dense_step), intent(inout) :: step
      !> A change by this share of the step is followed to rounding by a straight line
      real(wp), parameter :: straight = 1.0e-7_wp
      real(wp) :: h, full, change, rate
      integer :: k

      if (problem%series) then
         call step%cut(fraction)  ! the series is the solution itself
         return
      end if
      full = step%h
      h = fraction * full
      do k = 1, 4
         call dopri5_attempt(problem, step%t, h, q, v, a, atol_q, atol_v, rtol, step)
         if (abs(step%v) <= tiny(1.0_wp)) exit
         change = -step%q / step%v
         if (abs(change) <= 4.0_wp * spacing(step%t + h)) exit
         if (h + change <= 0.0_wp .or. h + change > 1.5_wp * full) exit
         if (abs(change) <= straight * h) then
            rate = step%v + change * step%a
            call step%cut(1.0_wp + change / h)
            step%q = 0.0_wp
            step%v = rate
            exit
         end if
         h = h + change
      end do
   end subroutine polish_impact

end module rocking_equation
