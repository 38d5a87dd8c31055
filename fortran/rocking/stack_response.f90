!> The response of two stacked blocks (rocking_stack) to a ground motion, mode by mode.
module rocking_stack_response
   use common_kinds, only : wp, gravity
   use common_lists, only : event_impact => rocking_event_impact, event_rest => rocking_event_rest, &
      event_uplift => rocking_event_uplift
   use common_signal, only : signal
   use rocking_modes, only : mode_history, mode_rocker, respond_in_modes
   use rocking_stack, only : choose_pivots, contact_forces, energies, motion_about, power, pressing, solved, stack, &
      stack_impact
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: stack_rock, stack_rows

   !> Rows of a history: q1, q2 [rad], their rates, ground to +x and up [m/s^2], kinetic and potential energy, work of
   !> the ground less loss at impacts [J], states of both contacts (0 shut, +1, -1), force of the ground on the lower
   !> and of the lower on the upper block, each x and y [N]
   integer, parameter :: stack_rows = 15

   !> A stack in one of its modes. Its state: q1, q2 [rad], their rates [rad/s], work of the ground [J]; contacts are
   !> 1 on the ground and 2 between.
   type, extends(mode_rocker) :: stack_rocker
      type(stack) :: body
      integer :: s(2) = 0                !! pivots
      real(wp) :: scale(2) = 0.0_wp      !! moments of the weights about the edges of the contacts [N m]
   contains
      procedure :: find_rates
      procedure :: inside
      procedure :: leave_mode
      procedure :: renew_mode
      procedure :: trim_state
      procedure :: fallen
      procedure :: resting
      procedure :: store_row
      procedure :: closes
   end type stack_rocker

contains

   !> Rock the stack from a state until the end time or collapse
   subroutine stack_rock(body, motion, start, end_time, tolerance, history, work, status)
      type(stack), intent(in) :: body
      type(signal), intent(in) :: motion
      real(wp), intent(in) :: start(4)    !! q1, q2 [rad], rates [rad/s]; at rest where zero
      real(wp), intent(in) :: end_time    !! [s]
      real(wp), intent(in) :: tolerance   !! relative, per step
      type(mode_history), intent(inout) :: history
      real(wp), intent(out) :: work       !! of the ground [J]
      integer(c_int), intent(out) :: status
      type(stack_rocker) :: rocker
      real(wp) :: y(5), atol(5), r

      rocker%body = body
      rocker%motion = motion
      rocker%scale = gravity * [sum(body%mass) * body%half(1), body%mass(2) * body%half(2)]
      y = [start, 0.0_wp]
      if (abs(y(1)) > 0.0_wp .or. abs(y(3)) > 0.0_wp) then
         rocker%s(1) = nint(sign(1.0_wp, merge(y(1), y(3), abs(y(1)) > 0.0_wp)))
      end if
      r = merge(y(2) - y(1), y(4) - y(3), abs(y(2) - y(1)) > 0.0_wp)
      if (abs(r) > 0.0_wp) rocker%s(2) = nint(sign(1.0_wp, r))
      rocker%moved = any(rocker%s /= 0)
      atol(1:2) = 0.01_wp * tolerance * maxval(body%limit)
      atol(3:4) = 10.0_wp * tolerance * maxval(body%rest_rate)
      atol(5) = tolerance * sum(body%mass) * gravity * body%half(1) * maxval(body%limit)
      call respond_in_modes(rocker, y, end_time, atol, tolerance, history, status)
      work = y(5)
   end subroutine stack_rock

   !> Rates of the state
   subroutine find_rates(system, t, y, rate)
      class(stack_rocker), intent(in) :: system
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: rate(:)
      real(wp) :: shaking(2)
      shaking = system%ground(t)
      rate(1:2) = y(3:4)
      rate(3:4) = solved(motion_about(system%body, system%s, y(1:2), y(3:4), shaking), system%s)
      rate(5) = power(system%body, system%s, y(1:2), y(3:4), shaking)
   end subroutine find_rates

   !> Above zero while open contacts are open and shut ones press
   function inside(body, t, y) result(margin)
      class(stack_rocker), intent(in) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: margin
      real(wp) :: shaking(2), push(2), q(2), v(2)
      q = y(1:2)
      v = y(3:4)
      margin = 1.0_wp
      associate (s => body%s)
         if (s(1) /= 0 .and. real(s(1), wp) * v(1) < 0.0_wp) margin = min(margin, real(s(1), wp) * q(1))
         if (s(2) /= 0 .and. real(s(2), wp) * (v(2) - v(1)) < 0.0_wp) then
            margin = min(margin, real(s(2), wp) * (q(2) - q(1)))
         end if
         if (any(s == 0)) then
            shaking = body%ground(t)
            push = pressing(body%body, s, q, v, solved(motion_about(body%body, s, q, v, shaking), s), shaking)
            ! an edge that presses with nothing has not parted yet
            margin = min(margin, minval(push / body%scale) + 1.0e-12_wp)
         end if
      end associate
   end function inside

   !> Numbers of contacts that are shut
   subroutine trim_state(body, y)
      class(stack_rocker), intent(in) :: body
      real(wp), intent(inout) :: y(:)
      if (body%s(1) == 0) y([1, 3]) = 0.0_wp
      if (body%s(2) == 0) y([2, 4]) = y([1, 3])
   end subroutine trim_state

   !> The contact about which it has turned past recall
   pure function fallen(body, y) result(place)
      class(stack_rocker), intent(in) :: body
      real(wp), intent(in) :: y(:)
      integer :: place
      place = findloc(abs([y(1), y(2) - y(1)]) >= body%body%limit, .true., dim=1)
   end function fallen

   !> Are both contacts shut?
   pure function resting(body) result(answer)
      class(stack_rocker), intent(in) :: body
      logical :: answer
      answer = all(body%s == 0)
   end function resting

   !> Which open contacts close at a state
   pure function closes(body, y) result(answer)
      class(stack_rocker), intent(in) :: body
      real(wp), intent(in) :: y(:)
      logical :: answer(2)
      real(wp) :: r(2), v(2)
      r = real(body%s, wp) * [y(1), y(2) - y(1)]
      v = real(body%s, wp) * [y(3), y(4) - y(3)]
      answer = body%s /= 0 .and. r <= 0.0_wp .and. v < 0.0_wp
   end function closes

   !> An impact where contacts close; else a contact no longer presses
   subroutine leave_mode(body, t, y, history)
      class(stack_rocker), intent(inout) :: body
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(:)
      type(mode_history), intent(inout) :: history
      real(wp) :: energy(2), gone(2), after(2)
      integer :: contact, pivots(2)
      logical :: at(2)

      at = body%closes(y)
      if (any(at)) then
         do contact = 1, 2
            if (.not. at(contact)) cycle
            history%impacts(contact) = history%impacts(contact) + 1
            call history%note_event(event_impact, t, contact)
         end do
         if (at(1)) then
            y(2) = y(2) - merge(y(1), 0.0_wp, body%s(2) == 0)
            y(1) = 0.0_wp
         end if
         if (at(2) .or. body%s(2) == 0) y(2) = y(1)
         energy = energies(body%body, body%s, y(1:2), y(3:4))
         call stack_impact(body%body, body%s, y(1:2), y(3:4), at, pivots, after)
         body%s = pivots
         y(3:4) = after
         gone = energies(body%body, body%s, y(1:2), y(3:4))
         history%loss = history%loss + energy(1) - gone(1)
         if (all(body%s == 0)) call history%note_event(event_rest, t, 0)
      end if
      call body%renew_mode(t, y, history)
   end subroutine leave_mode

   !> Contacts that are shut open where their edges no longer press
   subroutine renew_mode(body, t, y, history)
      class(stack_rocker), intent(inout) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      type(mode_history), intent(inout) :: history
      real(wp) :: x(2)
      integer :: before(2), contact
      logical :: touching(2)
      before = body%s
      touching = before == 0
      if (.not. any(touching)) return
      call choose_pivots(body%body, touching, body%s, y(1:2), y(3:4), body%ground(t), x)
      do contact = 1, 2
         if (before(contact) == 0 .and. body%s(contact) /= 0) call history%note_event(event_uplift, t, contact)
      end do
      body%moved = body%moved .or. any(body%s /= 0)
   end subroutine renew_mode

   !> What is stored of a state, see stack_rows
   subroutine store_row(body, t, y, loss, values)
      class(stack_rocker), intent(in) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: loss
      real(wp), intent(out) :: values(:)
      real(wp) :: shaking(2), a(2)
      shaking = body%ground(t)
      a = solved(motion_about(body%body, body%s, y(1:2), y(3:4), shaking), body%s)
      values(1:4) = y(1:4)
      values(5:6) = shaking
      values(7:8) = energies(body%body, body%s, y(1:2), y(3:4))
      values(9) = y(5) - loss
      values(10:11) = real(body%s, wp)
      values(12:15) = contact_forces(body%body, body%s, y(1:2), y(3:4), a, shaking)
   end subroutine store_row

end module rocking_stack_response
