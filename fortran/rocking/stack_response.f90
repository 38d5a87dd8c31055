!> The response of two stacked blocks (rocking_stack) to a ground motion, mode by mode.
module rocking_stack_response
   use common_kinds, only : wp, gravity
   use common_lists, only : event_impact => rocking_event_impact, event_rest => rocking_event_rest, &
      event_uplift => rocking_event_uplift
   use common_signal, only : signal
   use common_status, only : status_invalid_argument
   use rocking_modes, only : mode_history, mode_rocker, respond_in_modes
   use rocking_response, only : response, response_options
   use rocking_stack, only : choose_pivots, contact_forces, energies, motion_about, power, pressing, solved, stack, &
      stack_impact, stack_new, stack_parameters
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: stack_body, stack_body_new, stack_respond, stack_rock, stack_rows

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
      real(wp) :: critical(2) = huge(1.0_wp)  !! |q1| and |q2 - q1| up to which joints are checked [rad]
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
      procedure :: needed_at
   end type stack_rocker

   !> A stack as an ensemble rocks it: its numbers (see stack_parameters), then the critical rotations of both as one and
   !> of the upper block alone [rad], and the friction of both contacts, huge where they do not slide
   type :: stack_body
      type(stack) :: blocks
      real(wp) :: critical(2) = 0.0_wp
      real(wp) :: friction(2) = huge(1.0_wp)
   end type stack_body

contains

   !> Set up from the flat parameter list
   subroutine stack_body_new(parameters, body, status)
      real(wp), intent(in) :: parameters(:)  !! see stack_body
      type(stack_body), intent(out) :: body
      integer(c_int), intent(out) :: status
      status = status_invalid_argument
      if (size(parameters) /= stack_parameters + 4) return
      if (any(parameters(stack_parameters + 1:) <= 0.0_wp)) return
      body%critical = parameters(stack_parameters + 1:stack_parameters + 2)
      body%friction = parameters(stack_parameters + 3:)
      call stack_new(parameters(:stack_parameters), body%blocks, status)
   end subroutine stack_body_new

   !> One member of an ensemble: started with both blocks rotated as one, its outcome alone. Half cycles: one per uplift
   !> from rest and per instant of impact
   subroutine stack_respond(body, motion, options, answer, status)
      type(stack_body), intent(in) :: body
      type(signal), intent(in) :: motion
      type(response_options), intent(in) :: options
      type(response), intent(out) :: answer
      integer(c_int), intent(out) :: status
      type(stack_rocker) :: rocker
      type(mode_history) :: record
      real(wp) :: q, v, work, own(2), reached(2)
      real(wp), target :: no_time(0), no_rows(0, 0), no_events(2, 0)
      integer(c_int), target :: no_kinds(0)
      integer :: greater

      record%time => no_time
      record%state => no_rows
      record%event_kind => no_kinds
      record%event => no_events
      rocker%critical = body%critical
      rocker%friction = body%friction
      q = real(options%start_side, wp) * options%start_q
      v = real(options%start_side, wp) * options%start_v
      call rock_blocks(rocker, body%blocks, motion, [q, q, v, v], options%end_time, options%tolerance, record, work, status)
      own = merge(record%most([1, 3]), record%least([1, 3]), record%most([1, 3]) >= -record%least([1, 3]))
      reached = abs(own) / body%critical
      greater = maxloc(reached, dim=1)
      answer%outcome = record%outcome
      answer%half_cycles = record%half_cycles
      answer%impacts = sum(record%impacts)
      answer%peak = own(greater)
      answer%peak_ratio = reached(greater)
      answer%stop_time = record%stop_time
      answer%steps = record%steps
      answer%settled = record%settled
      answer%joints = rocker%demand
   end subroutine stack_respond

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
      call rock_blocks(rocker, body, motion, start, end_time, tolerance, history, work, status)
   end subroutine stack_rock

   !> The same for a mechanism with the demand on its joints
   subroutine rock_blocks(rocker, body, motion, start, end_time, tolerance, history, work, status)
      type(stack_rocker), intent(inout) :: rocker
      type(stack), intent(in) :: body
      type(signal), intent(in) :: motion
      real(wp), intent(in) :: start(4)    !! q1, q2 [rad], rates [rad/s]; at rest where zero
      real(wp), intent(in) :: end_time    !! [s]
      real(wp), intent(in) :: tolerance   !! relative, per step
      type(mode_history), intent(inout) :: history
      real(wp), intent(out) :: work       !! of the ground [J]
      integer(c_int), intent(out) :: status
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
      if (rocker%moved) history%half_cycles = 1
      atol(1:2) = 0.01_wp * tolerance * maxval(body%limit)
      atol(3:4) = 10.0_wp * tolerance * maxval(body%rest_rate)
      atol(5) = tolerance * sum(body%mass) * gravity * body%half(1) * maxval(body%limit)
      call respond_in_modes(rocker, y, end_time, atol, tolerance, history, status)
      work = y(5)
   end subroutine rock_blocks

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

   !> The contact about which it has rotated beyond recovery
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
         history%half_cycles = history%half_cycles + 1
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
      if (all(touching) .and. any(body%s /= 0)) history%half_cycles = history%half_cycles + 1
      body%moved = body%moved .or. any(body%s /= 0)
   end subroutine renew_mode

   !> Friction that both joints need while the stack rocks, huge where a joint parts; 0 beyond the critical rotations
   function needed_at(body, t, y) result(needed)
      class(stack_rocker), intent(in) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: needed(2)
      real(wp) :: shaking(2), a(2), force(4), normal(2)
      needed = 0.0_wp
      if (any(abs([y(1), y(2) - y(1)]) > body%critical)) return
      shaking = body%ground(t)
      a = solved(motion_about(body%body, body%s, y(1:2), y(3:4), shaking), body%s)
      force = contact_forces(body%body, body%s, y(1:2), y(3:4), a, shaking)
      ! the joint between turns with the lower block
      normal = [force(2), sin(y(1)) * force(3) + cos(y(1)) * force(4)]
      needed = abs([force(1), cos(y(1)) * force(3) - sin(y(1)) * force(4)])
      where (normal > 0.0_wp)
         needed = needed / normal
      else where
         needed = huge(1.0_wp)
      end where
   end function needed_at

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
