!> The response of a block on a compliant base (rocking_soft_base) to a ground motion, mode by mode.
module rocking_soft_base_response
   use common_kinds, only : wp, gravity, pi
   use common_lists, only : event_impact => rocking_event_impact, event_uplift => rocking_event_uplift
   use common_signal, only : signal
   use common_status, only : status_invalid_argument
   use rocking_modes, only : mode_history, mode_rocker, respond_in_modes
   use rocking_response, only : response, response_options
   use rocking_soft_base, only : accelerations, base_contact, contact_of, energies, decides, find_restoring, lever, &
      take_signs, &
      settled, soft_base, soft_base_new, soft_base_parameters, velocity, watched
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: soft_base_body, soft_base_body_new, soft_base_respond, soft_base_rock, soft_base_rows, soft_base_state

   !> Numbers of the state: q [rad], z [m], their rates, work of the ground, energy that the base has taken up [J]
   integer, parameter :: soft_base_state = 6
   !> Rows of a history: q, z, their rates, ground to +x and up [m/s^2], kinetic energy, potential energy with that of
   !> the springs, work of the ground less what the base took up [J], force of the base to +x and up [N], range of the
   !> base that pushes, from the foot [m], greatest pressure per length [N/m] or force of an edge [N], angular
   !> acceleration [rad/s^2]
   integer, parameter :: soft_base_rows = 15

   !> A block in one of its modes; events name the left (-1) or the right (1) edge
   type, extends(mode_rocker) :: soft_base_rocker
      type(soft_base) :: block
      real(wp) :: critical(2) = 0.0_wp   !! from which gravity takes it down, to +x and to -x; 0 not known [rad]
      logical :: stop_when_safe = .false.
      integer :: half_cycle = 0          !! side of the last half cycle begun, 0 none
   contains
      procedure :: find_rates
      procedure :: inside
      procedure :: leave_mode
      procedure :: fallen
      procedure :: upright
      procedure :: known
      procedure :: store_row
      procedure :: needed_at
   end type soft_base_rocker

   !> A block as an ensemble rocks it: its numbers (see soft_base_parameters), then the critical rotations to +x and to
   !> -x, both above zero [rad], and the friction of its base, huge where it does not slide
   type :: soft_base_body
      type(soft_base) :: block
      real(wp) :: critical(2) = 0.0_wp
      real(wp) :: friction = huge(1.0_wp)
   end type soft_base_body

   !> A base that presses with less than this share of the weight lets the block fly
   real(wp), parameter :: flies = 0.01_wp
   !> Over sqrt(height of the centre / g): friction that fails no longer before the base lifts off fails as the force vanishes. The
   !> block slides by about half the square of this share of that height before
   real(wp), parameter :: at_once = 0.01_wp

contains

   !> Set up from the flat parameter list
   subroutine soft_base_body_new(parameters, body, status)
      real(wp), intent(in) :: parameters(:)  !! see soft_base_body
      type(soft_base_body), intent(out) :: body
      integer(c_int), intent(out) :: status
      status = status_invalid_argument
      if (size(parameters) /= soft_base_parameters + 3) return
      if (any(parameters(soft_base_parameters + 1:) <= 0.0_wp)) return
      body%critical = parameters(soft_base_parameters + 1:soft_base_parameters + 2)
      body%friction = parameters(soft_base_parameters + 3)
      call soft_base_new(parameters(:soft_base_parameters), body%block, status)
   end subroutine soft_base_body_new

   !> One member of an ensemble: started rotated and free to settle, its outcome alone
   subroutine soft_base_respond(body, motion, options, answer, status)
      type(soft_base_body), intent(in) :: body
      type(signal), intent(in) :: motion
      type(response_options), intent(in) :: options
      type(response), intent(out) :: answer
      integer(c_int), intent(out) :: status
      type(soft_base_rocker) :: rocker
      type(mode_history) :: record
      real(wp) :: y(soft_base_state), peaks(2)
      real(wp), target :: no_time(0), no_rows(0, 0), no_events(2, 0)
      integer(c_int), target :: no_kinds(0)

      record%time => no_time
      record%state => no_rows
      record%event_kind => no_kinds
      record%event => no_events
      rocker%block = body%block
      rocker%critical = body%critical
      rocker%friction = body%friction
      rocker%stop_when_safe = options%stop_when_safe
      y = 0.0_wp
      y(1) = real(options%start_side, wp) * options%start_q
      y(2) = settled(body%block, y(1))
      y(3) = real(options%start_side, wp) * options%start_v
      call rock_block(rocker, motion, y, options%end_time, options%tolerance, record, status)
      peaks = record%peak()
      answer%outcome = record%outcome
      answer%half_cycles = record%half_cycles
      answer%impacts = sum(record%impacts)
      answer%peak = peaks(1)
      answer%peak_ratio = reached(rocker, record)
      answer%stop_time = record%stop_time
      answer%steps = record%steps
      answer%settled = record%settled
      answer%joints = rocker%demand
      associate (found => answer%joints)
         if (found%leaves_at >= 0.0_wp .and. found%slips_at >= found%leaves_at - at_once * sqrt(body%block%height / gravity)) then
            found%slips_at = -1.0_wp
            found%slips = 0
         end if
      end associate
   end subroutine soft_base_respond

   !> Rock the block from a state until the end time or collapse
   subroutine soft_base_rock(block, motion, y, end_time, tolerance, history, status)
      type(soft_base), intent(in) :: block
      type(signal), intent(in) :: motion
      real(wp), intent(inout) :: y(:)     !! q [rad], z [m] and their rates, then zeros; at the end the state reached
      real(wp), intent(in) :: end_time    !! [s]
      real(wp), intent(in) :: tolerance   !! relative, per step
      type(mode_history), intent(inout) :: history
      integer(c_int), intent(out) :: status
      type(soft_base_rocker) :: rocker
      rocker%block = block
      call rock_block(rocker, motion, y, end_time, tolerance, history, status)
   end subroutine soft_base_rock

   !> The same of a rocker whose options are set
   subroutine rock_block(rocker, motion, y, end_time, tolerance, history, status)
      type(soft_base_rocker), intent(inout) :: rocker
      type(signal), intent(in) :: motion
      real(wp), intent(inout) :: y(:)
      real(wp), intent(in) :: end_time
      real(wp), intent(in) :: tolerance
      type(mode_history), intent(inout) :: history
      integer(c_int), intent(out) :: status
      real(wp) :: atol(soft_base_state), stiffness, sunk, angle, unit

      status = status_invalid_argument
      if (size(y) /= soft_base_state) return
      rocker%motion = motion
      associate (block => rocker%block)
         ! a step that is longer than a cycle of the springs may be blind to it
         stiffness = block%stiffness * merge(2.0_wp, block%place(2) - block%place(1), block%edges)
         rocker%longest = min(rocker%longest, 0.25_wp * pi * sqrt(block%mass / stiffness))
         sunk = block%mass * gravity / stiffness
         angle = maxval(block%limit)
         unit = sqrt(gravity / block%height)
         atol(1:4) = 0.01_wp * tolerance * [angle, sunk, angle * unit, sqrt(gravity * sunk)]
         atol(5:6) = tolerance * block%mass * gravity * maxval(abs(block%place)) * angle
         call take_signs(rocker%block, y)
         if (.not. abs(y(1)) > 0.0_wp) rocker%block%side = 1
         rocker%moved = any(rocker%block%down < 0)
         if (rocker%moved) call begin_half_cycle(rocker, rocker%block%side, history)
      end associate
      call respond_in_modes(rocker, y, end_time, atol, tolerance, history, status)
   end subroutine rock_block

   !> A half cycle begins where the edge away from which it leans lifts, unless the last one was to the same side
   subroutine begin_half_cycle(rocker, side, history)
      type(soft_base_rocker), intent(inout) :: rocker
      integer, intent(in) :: side  !! to which it leans
      type(mode_history), intent(inout) :: history
      if (side == rocker%half_cycle) return
      rocker%half_cycle = side
      history%half_cycles = history%half_cycles + 1
   end subroutine begin_half_cycle

   !> Greatest rotation so far over the critical one of its side
   pure function reached(rocker, history) result(ratio)
      type(soft_base_rocker), intent(in) :: rocker
      type(mode_history), intent(in) :: history
      real(wp) :: ratio
      ratio = max(history%most(1) / rocker%critical(1), -history%least(1) / rocker%critical(2))
   end function reached

   !> Too little energy is left to reach the critical rotation of either side; false where these are not known
   pure function upright(body, y) result(answer)
      class(soft_base_rocker), intent(in) :: body
      real(wp), intent(in) :: y(:)
      logical :: answer
      answer = all(body%critical > 0.0_wp) .and. y(1) < body%critical(1) .and. y(1) > -body%critical(2)
      if (answer) answer = stays_below(body, y, 1.0_wp)
   end function upright

   !> Outcome and peak are known where the energy left reaches no further than so far
   pure function known(body, y, history) result(answer)
      class(soft_base_rocker), intent(in) :: body
      real(wp), intent(in) :: y(:)
      type(mode_history), intent(in) :: history
      logical :: answer
      answer = body%stop_when_safe .and. body%moved
      if (answer) answer = body%upright(y)
      if (answer) answer = stays_below(body, y, min(1.0_wp, reached(body, history)))
   end function known

   !> Too little energy is left to reach a share of the critical rotation of either side
   pure function stays_below(rocker, y, share) result(answer)
      type(soft_base_rocker), intent(in) :: rocker
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: share
      logical :: answer
      real(wp) :: energy(2), sunk, moment
      call find_restoring(rocker%block, share * rocker%critical(1), sunk, energy(1), moment)
      call find_restoring(rocker%block, -share * rocker%critical(2), sunk, energy(2), moment)
      answer = sum(energies(rocker%block, y, contact_of(rocker%block, y))) < minval(energy)
   end function stays_below

   !> Rates of the state
   subroutine find_rates(system, t, y, rate)
      class(soft_base_rocker), intent(in) :: system
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: rate(:)
      real(wp) :: shaking(2)
      type(base_contact) :: base
      shaking = system%ground(t)
      base = contact_of(system%block, y)
      rate(1:2) = y(3:4)
      rate(3:4) = accelerations(system%block, y, base, shaking)
      rate(5) = -system%block%mass * dot_product(shaking, velocity(system%block, y))
      rate(6) = base%spent
   end subroutine find_rates

   !> Above zero while all signs stay
   function inside(body, t, y) result(margin)
      class(soft_base_rocker), intent(in) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: margin
      real(wp) :: value(6)
      logical :: mask(6)
      value = watched(body%block, y)
      mask = decides(body%block)
      ! what stands upright leans to no side
      mask(6) = mask(6) .and. abs(value(6)) > 0.0_wp
      associate (b => body%block)
         margin = minval(value * real([b%down, b%push, b%root, b%side], wp), mask=mask)
      end associate
      associate (unused => t)
      end associate
   end function inside

   !> An edge lifts or lands, or its dashpot would pull
   subroutine leave_mode(body, t, y, history)
      class(soft_base_rocker), intent(inout) :: body
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(:)
      type(mode_history), intent(inout) :: history
      integer :: before(2), i
      before = body%block%down
      call take_signs(body%block, y)
      do i = 1, 2
         if (body%block%down(i) == before(i)) cycle
         if (body%block%down(i) < 0) then
            body%moved = .true.
            call history%note_event(event_uplift, t, 2 * i - 3)
            if (y(1) * body%block%place(i) < 0.0_wp) call begin_half_cycle(body, 3 - 2 * i, history)
         else
            history%impacts(i) = history%impacts(i) + 1
            call history%note_event(event_impact, t, 2 * i - 3)
         end if
      end do
   end subroutine leave_mode

   !> The edge over which it has rotated beyond recovery: -1, 1, 0 none
   pure function fallen(body, y) result(place)
      class(soft_base_rocker), intent(in) :: body
      real(wp), intent(in) :: y(:)
      integer :: place
      place = 0
      if (y(1) <= -body%block%limit(1)) place = -1
      if (y(1) >= body%block%limit(2)) place = 1
   end function fallen

   !> Friction that the base needs up to the critical rotations, huge where the block flies
   function needed_at(body, t, y) result(needed)
      class(soft_base_rocker), intent(in) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: needed(2)
      type(base_contact) :: base
      real(wp) :: shaking(2), a(2), x(2)
      needed = 0.0_wp
      if (all(body%critical > 0.0_wp) .and. (y(1) > body%critical(1) .or. y(1) < -body%critical(2))) return
      shaking = body%ground(t)
      associate (block => body%block)
         base = contact_of(block, y)
         needed(1) = huge(1.0_wp)
         if (base%force < flies * block%mass * gravity) return
         a = accelerations(block, y, base, shaking)
         x = lever(block, y(1))
         needed(1) = abs(block%mass * (x(1) * a(1) + x(2) * y(3)**2 + shaking(1))) / base%force
      end associate
   end function needed_at

   !> What is stored of a state, see soft_base_rows
   subroutine store_row(body, t, y, loss, values)
      class(soft_base_rocker), intent(in) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: loss
      real(wp), intent(out) :: values(:)
      type(base_contact) :: base
      real(wp) :: shaking(2), a(2), x(2)
      shaking = body%ground(t)
      associate (block => body%block)
         base = contact_of(block, y)
         a = accelerations(block, y, base, shaking)
         x = lever(block, y(1))
         values(1:4) = y(1:4)
         values(5:6) = shaking
         values(7:8) = energies(block, y, base)
         values(9) = y(5) - y(6) - loss
         values(10) = block%mass * (x(1) * a(1) + x(2) * y(3)**2 + shaking(1))
         values(11) = base%force
         values(12:13) = base%range
         values(14) = base%most
         values(15) = a(1)
      end associate
   end subroutine store_row

end module rocking_soft_base_response
