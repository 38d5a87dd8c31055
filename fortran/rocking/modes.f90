!> The response of a structure of several coordinates whose equation changes from mode to mode: two stacked blocks,
!> a block on a compliant base.
!>
!> Within a mode the equation is smooth. A step ends where its mode does, found by bisection of the step itself, so that
!> the order of the method holds; what comes then, another mode or an impact, the structure says. The integrator stops
!> at every break of the ground motion and at every output time.
module rocking_modes
   use common_cancel, only : cancel_requested
   use common_dopri5_system, only : dopri5_system_step, first_order_system, most_numbers
   use common_kinds, only : wp
   use common_lists, only : event_collapse => rocking_event_collapse, outcome_collapse => rocking_outcome_collapse, &
      outcome_no_hinging => rocking_outcome_no_hinging, outcome_recovery => rocking_outcome_recovery
   use common_signal, only : signal
   use common_status, only : status_ok, status_cancelled, status_invalid_argument, status_step_too_small, &
      status_too_many_steps
   use rocking_watch, only : joint_demand
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: mode_rocker, mode_history, respond_in_modes

   integer, parameter :: poll_every = 500
   integer, parameter :: max_attempts = 20000000
   !> Places within a step at which its mode is looked at, besides its end
   real(wp), parameter :: looks(3) = [0.25_wp, 0.5_wp, 0.75_wp]

   !> A structure in one of its modes, under a ground motion
   type, abstract, extends(first_order_system) :: mode_rocker
      type(signal) :: motion
      integer :: segment = 0       !! of the motion
      real(wp) :: longest = 0.05_wp  !! step [s]
      logical :: moved = .false.   !! something opened
      real(wp) :: friction(2) = huge(1.0_wp)  !! of the contacts
      type(joint_demand) :: demand            !! on the contacts
      real(wp) :: before = 0.0_wp             !! time of the demand noted last [s], and its state
      real(wp) :: state_before(4) = 0.0_wp
   contains
      procedure :: ground
      procedure(inside), deferred :: inside
      procedure(leave_mode), deferred :: leave_mode
      procedure(fallen), deferred :: fallen
      procedure(store_row), deferred :: store_row
      procedure(needed_at), deferred :: needed_at
      procedure :: renew_mode
      procedure :: trim_state
      procedure :: resting
      procedure :: upright
      procedure :: known
      procedure :: note_demand
   end type mode_rocker

   !> In the caller's arrays
   type :: mode_history
      integer :: points = 0
      real(wp), pointer, contiguous :: time(:) => null()      !! requested, ascending [s]
      real(wp), pointer, contiguous :: state(:, :) => null()  !! (rows of the structure, points)
      integer :: events = 0
      integer(c_int), pointer, contiguous :: event_kind(:) => null()
      real(wp), pointer, contiguous :: event(:, :) => null()  !! (2, room): time [s], place: a contact or an edge
      integer(c_int) :: outcome = outcome_no_hinging
      integer(c_int) :: impacts(2) = 0   !! at each contact or edge
      integer(c_int) :: half_cycles = 0  !! begun, of structures that count them
      integer(c_int) :: steps = 0
      logical :: settled = .false.       !! collapsed, or can no longer collapse after the motion
      !> Least and greatest value of the first two numbers of the state, and of the second less the first
      real(wp) :: least(3) = 0.0_wp
      real(wp) :: most(3) = 0.0_wp
      real(wp) :: loss = 0.0_wp          !! energy lost at impacts [J]
      real(wp) :: stop_time = 0.0_wp     !! [s]
   contains
      procedure :: note_event
      procedure :: peak
   end type mode_history

   abstract interface
      !> Friction that both contacts need in a state, huge where one parts as a whole; 0 where nothing is needed
      function needed_at(body, t, y) result(needed)
         import :: mode_rocker, wp
         implicit none (type, external)
         class(mode_rocker), intent(in) :: body
         real(wp), intent(in) :: t     !! [s]
         real(wp), intent(in) :: y(:)  !! the first four numbers of the state
         real(wp) :: needed(2)
      end function needed_at

      !> Above zero while the mode holds
      function inside(body, t, y) result(margin)
         import :: mode_rocker, wp
         implicit none (type, external)
         class(mode_rocker), intent(in) :: body
         real(wp), intent(in) :: t     !! [s]
         real(wp), intent(in) :: y(:)  !! state
         real(wp) :: margin
      end function inside

      !> The mode has ended: into the next one, by an impact or not
      subroutine leave_mode(body, t, y, history)
         import :: mode_rocker, mode_history, wp
         implicit none (type, external)
         class(mode_rocker), intent(inout) :: body
         real(wp), intent(in) :: t
         real(wp), intent(inout) :: y(:)
         type(mode_history), intent(inout) :: history
      end subroutine leave_mode

      !> The place about which it has rotated beyond recovery, 0 where it stands
      pure function fallen(body, y) result(place)
         import :: mode_rocker, wp
         implicit none (type, external)
         class(mode_rocker), intent(in) :: body
         real(wp), intent(in) :: y(:)
         integer :: place
      end function fallen

      !> What is stored of a state
      subroutine store_row(body, t, y, loss, values)
         import :: mode_rocker, wp
         implicit none (type, external)
         class(mode_rocker), intent(in) :: body
         real(wp), intent(in) :: t
         real(wp), intent(in) :: y(:)
         real(wp), intent(in) :: loss      !! energy lost at impacts so far [J]
         real(wp), intent(out) :: values(:)
      end subroutine store_row
   end interface

contains

   !> Acceleration of the ground, to +x and up [m/s^2]
   function ground(body, t) result(a)
      class(mode_rocker), intent(in) :: body
      real(wp), intent(in) :: t  !! [s]
      real(wp) :: a(2)
      call body%motion%value_at(body%segment, t, a(1), a(2))
   end function ground

   !> The ground may have jumped: the mode that follows; the same, unless a structure says otherwise
   subroutine renew_mode(body, t, y, history)
      class(mode_rocker), intent(inout) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      type(mode_history), intent(inout) :: history
      associate (unused => body%moved, unused_t => t, unused_y => y, unused_history => history%events)
      end associate
   end subroutine renew_mode

   !> Numbers that the mode fixes, without the error of the step; none, unless a structure says otherwise
   subroutine trim_state(body, y)
      class(mode_rocker), intent(in) :: body
      real(wp), intent(inout) :: y(:)
      associate (unused => body%moved, unused_y => y)
      end associate
   end subroutine trim_state

   !> Does it stay as it is where the ground is quiet? Never, unless a structure says otherwise
   pure function resting(body) result(answer)
      class(mode_rocker), intent(in) :: body
      logical :: answer
      answer = .false.
      associate (unused => body%moved)
      end associate
   end function resting

   !> Can the structure no longer collapse while the ground is quiet? Not while it moves, unless a structure says otherwise
   pure function upright(body, y) result(answer)
      class(mode_rocker), intent(in) :: body
      real(wp), intent(in) :: y(:)
      logical :: answer
      answer = body%resting()
      associate (unused_y => y)
      end associate
   end function upright

   !> Are all requested results known while the ground is quiet? Never, unless a structure says otherwise
   pure function known(body, y, history) result(answer)
      class(mode_rocker), intent(in) :: body
      real(wp), intent(in) :: y(:)
      type(mode_history), intent(in) :: history
      logical :: answer
      answer = .false.
      associate (unused => body%moved, unused_y => y, unused_history => history%events)
      end associate
   end function known

   !> Friction that the contacts need, and whether one parts as a whole; the first time of each lies within the step since the
   !> state before
   subroutine note_demand(body, t, y)
      class(mode_rocker), intent(inout) :: body
      real(wp), intent(in) :: t     !! [s]
      real(wp), intent(in) :: y(:)  !! state
      integer, parameter :: within = 4, halvings = 30
      real(wp) :: needed(2), low, high, middle
      integer :: i, k, contact
      logical :: first(2)  ! sliding and parting have not come before this step

      first = [body%demand%slips_at, body%demand%leaves_at] < 0.0_wp
      do i = 1, within
         if (i < within .and. .not. t > body%before) cycle
         high = real(i, wp) / real(within, wp)
         needed = needed_within(high)
         if (.not. body%resting()) body%demand%friction = max(body%demand%friction, maxval(needed))
         do k = 1, 2
            contact = fails(k, needed)
            if (.not. first(k) .or. contact == 0) cycle
            low = high - 1.0_wp / real(within, wp)
            do while (high - low > 0.5_wp**halvings)
               middle = 0.5_wp * (low + high)
               if (fails(k, needed_within(middle)) == 0) then
                  low = middle
               else
                  high = middle
               end if
            end do
            first(k) = .false.
            if (k == 1) then
               body%demand%slips_at = body%before + high * (t - body%before)
               body%demand%slips = contact
            else
               body%demand%leaves_at = body%before + high * (t - body%before)
               body%demand%leaves = contact
            end if
            high = real(i, wp) / real(within, wp)
         end do
      end do
      body%before = t
      body%state_before = y(1:4)

   contains

      !> The contact that slides (k = 1) or parts (k = 2), 0 none
      pure function fails(k, demand) result(found)
         integer, intent(in) :: k
         real(wp), intent(in) :: demand(2)
         integer :: found
         found = findloc(demand > merge(body%friction, 0.5_wp * huge(1.0_wp), k == 1), .true., dim=1)
      end function fails

      !> Friction at a fraction of the step: places by the cubic through both ends, rates linear
      function needed_within(s) result(demand)
         real(wp), intent(in) :: s
         real(wp) :: demand(2)
         real(wp) :: h, at(4)
         h = t - body%before
         at = y(1:4)
         if (s < 1.0_wp) then
            associate (p => body%state_before)
               at(1:2) = p(1:2) + s**2 * (3.0_wp - 2.0_wp * s) * (y(1:2) - p(1:2)) &
                  + h * s * (1.0_wp - s) * ((1.0_wp - s) * p(3:4) - s * y(3:4))
               at(3:4) = p(3:4) + s * (y(3:4) - p(3:4))
            end associate
         end if
         demand = body%needed_at(body%before + s * h, at)
      end function needed_within

   end subroutine note_demand

   !> The first two numbers of the state where they were farthest from zero
   pure function peak(history) result(values)
      class(mode_history), intent(in) :: history
      real(wp) :: values(2)
      values = merge(history%most(1:2), history%least(1:2), history%most(1:2) >= -history%least(1:2))
   end function peak

   !> Keep an event, as far as there is room
   subroutine note_event(history, kind, t, place)
      class(mode_history), intent(inout) :: history
      integer(c_int), intent(in) :: kind
      real(wp), intent(in) :: t
      integer, intent(in) :: place
      history%events = history%events + 1
      if (history%events > size(history%event_kind)) return
      history%event_kind(history%events) = kind
      history%event(:, history%events) = [t, real(place, wp)]
   end subroutine note_event

   !> From a state until the end time or collapse
   subroutine respond_in_modes(body, y, end_time, atol, tolerance, history, status)
      class(mode_rocker), intent(inout) :: body
      real(wp), intent(inout) :: y(:)     !! state at time zero, and at the end
      real(wp), intent(in) :: end_time    !! [s]
      real(wp), intent(in) :: atol(:)     !! absolute tolerances of the state
      real(wp), intent(in) :: tolerance   !! relative, per step
      type(mode_history), intent(inout) :: history
      integer(c_int), intent(out) :: status
      real(wp), dimension(most_numbers) :: fresh, rate, rate_there
      real(wp) :: t, h, h_next, error, t_next
      integer :: attempts, k, n
      logical :: quiet, ended, rate_known

      status = status_invalid_argument
      n = size(y)
      if (n > most_numbers) return
      status = status_ok
      do k = 1, 2
         call note_value(k, y(k))
      end do
      call note_value(3, y(2) - y(1))
      rate_known = .false.
      t = 0.0_wp
      body%state_before = y(1:4)
      body%segment = 0
      do while (body%segment <= body%motion%segments)
         if (body%motion%break_time(body%segment + 1) > t) exit
         body%segment = body%segment + 1
      end do
      h_next = 1.0e-3_wp
      attempts = 0
      call body%renew_mode(t, y, history)
      do while (t < end_time)
         attempts = attempts + 1
         if (attempts > max_attempts) status = status_too_many_steps
         if (mod(attempts, poll_every) == 0) then
            if (cancel_requested()) status = status_cancelled
         end if
         if (status /= status_ok) exit
         call write_out()
         quiet = body%segment > body%motion%segments
         t_next = end_time
         if (.not. quiet) t_next = min(t_next, body%motion%break_time(body%segment + 1))
         if (history%points < size(history%time)) t_next = min(t_next, max(history%time(history%points + 1), t))
         if (quiet .and. body%resting()) then
            t = t_next
            if (history%points >= size(history%time)) t = end_time
            cycle
         end if
         h = min(h_next, body%longest, 0.125_wp * body%motion%shortest_period(body%segment))
         if (h >= t_next - t) then
            h = t_next - t
         else if (h > 0.5_wp * (t_next - t)) then
            h = 0.5_wp * (t_next - t)
         end if
         if (h <= 4.0_wp * spacing(t)) then
            t = t_next
            call next_segment()
            cycle
         end if
         if (.not. rate_known) call body%find_rates(t, y, rate(:n))
         rate_known = .true.
         call take_step(h)
         if (.not. error <= 1.0_wp) then
            h_next = h * merge(max(0.1_wp, 0.9_wp * error**(-0.2_wp)), 0.1_wp, error <= huge(error))
            if (h_next <= 8.0_wp * spacing(max(t, 1.0e-3_wp))) status = status_step_too_small
            cycle
         end if
         h_next = max(h_next, h) * min(5.0_wp, max(0.2_wp, 0.9_wp * max(error, 1.0e-10_wp)**(-0.2_wp)))
         if (h_next > 4.0_wp * h) h_next = max(4.0_wp * h, 1.0e-4_wp)
         history%steps = history%steps + 1
         call end_of_mode()
         t = merge(t_next, t + h, h >= t_next - t)
         call note_peaks()
         y = fresh(:n)
         rate = rate_there
         call body%note_demand(t, y)
         if (body%fallen(y) /= 0) then
            call history%note_event(event_collapse, t, body%fallen(y))
            history%outcome = outcome_collapse
            exit
         end if
         if (ended) then
            call body%leave_mode(t, y, history)
            call body%note_demand(t, y)
            rate_known = .false.
            h_next = min(h_next, 1.0e-3_wp)
         end if
         call next_segment()
         if (quiet) then
            if (body%known(y, history)) exit
         end if
      end do
      history%stop_time = t
      call write_out()
      if (history%outcome /= outcome_collapse) then
         if (body%moved) history%outcome = outcome_recovery
         history%settled = body%segment > body%motion%segments .and. body%upright(y) .and. status == status_ok
      else
         history%settled = .true.
      end if

   contains

      !> One step from the present state
      subroutine take_step(length)
         real(wp), intent(in) :: length
         call dopri5_system_step(body, t, length, y, rate(:n), atol, tolerance, fresh(:n), rate_there(:n), error)
         call body%trim_state(fresh(:n))
      end subroutine take_step

      !> Where the mode ends within the step, the step ends there
      subroutine end_of_mode()
         real(wp) :: low, high, middle, between(most_numbers)
         integer :: i
         low = 0.0_wp
         do i = 1, size(looks)
            call interpolate_state(looks(i), between(:n))
            call body%trim_state(between(:n))
            if (body%inside(t + looks(i) * h, between(:n)) <= 0.0_wp) exit
            low = looks(i) * h
         end do
         if (i <= size(looks)) then
            ! the step itself decides, not its polynomial
            call take_step(looks(i) * h)
            ended = body%inside(t + looks(i) * h, fresh(:n)) <= 0.0_wp
            h = looks(i) * h
            low = 0.0_wp
         else
            ended = body%inside(t + h, fresh(:n)) <= 0.0_wp
         end if
         if (.not. ended) return
         high = h
         do i = 1, 60
            middle = 0.5_wp * (low + high)
            if (high - low <= 4.0_wp * spacing(t + h)) exit
            call take_step(middle)
            if (body%inside(t + middle, fresh(:n)) <= 0.0_wp) then
               high = middle
            else
               low = middle
            end if
         end do
         h = high
         call take_step(h)
      end subroutine end_of_mode

      !> The state at a fraction of the step, by the cubic through its ends
      pure subroutine interpolate_state(s, z)
         real(wp), intent(in) :: s
         real(wp), intent(out) :: z(:)
         z = y + s**2 * (3.0_wp - 2.0_wp * s) * (fresh(:n) - y) &
            + h * s * (1.0_wp - s) * ((1.0_wp - s) * rate(:n) - s * rate_there(:n))
      end subroutine interpolate_state

      !> To the next segment of the ground motion where its break is reached
      subroutine next_segment()
         if (body%segment > body%motion%segments) return
         if (t < body%motion%break_time(body%segment + 1)) return
         if (.not. body%motion%smooth_to_next(body%segment)) then
            h_next = min(h_next, 1.0e-3_wp)
            rate_known = .false.
         end if
         body%segment = body%segment + 1
         call body%renew_mode(t, y, history)
      end subroutine next_segment

      !> The end of the step, and where a number turns within it
      subroutine note_peaks()
         integer :: k
         do k = 1, 2
            call note_within(k, y(k), fresh(k), rate(k), rate_there(k))
         end do
         call note_within(3, y(2) - y(1), fresh(2) - fresh(1), rate(2) - rate(1), rate_there(2) - rate_there(1))
      end subroutine note_peaks

      !> A number from its values and rates at both ends of the step
      subroutine note_within(k, first, last, rate_first, rate_last)
         integer, intent(in) :: k
         real(wp), intent(in) :: first, last, rate_first, rate_last
         call note_value(k, last)
         if (rate_first * rate_last < 0.0_wp) call note_value(k, turning(first, last, h * rate_first, h * rate_last))
      end subroutine note_within

      subroutine note_value(k, value)
         integer, intent(in) :: k
         real(wp), intent(in) :: value
         history%least(k) = min(history%least(k), value)
         history%most(k) = max(history%most(k), value)
      end subroutine note_value

      !> A number where its rate changes sign within the step, by the cubic through its ends
      pure function turning(first, last, c, d) result(value)
         real(wp), intent(in) :: first, last  !! values
         real(wp), intent(in) :: c, d         !! rates times the step
         real(wp) :: value
         real(wp) :: s, a, b, root
         ! rate over the step: a s^2 + b s + c
         a = 3.0_wp * (c + d) - 6.0_wp * (last - first)
         b = d - c - a
         ! its ends are of unlike sign: one of the two roots lies within
         root = b + sign(sqrt(max(b * b - 4.0_wp * a * c, 0.0_wp)), b)
         s = -2.0_wp * c / root
         if (.not. (s >= 0.0_wp .and. s <= 1.0_wp)) s = -root / (2.0_wp * a)
         value = last
         if (.not. (s >= 0.0_wp .and. s <= 1.0_wp)) return
         value = first + s**2 * (3.0_wp - 2.0_wp * s) * (last - first) + s * (1.0_wp - s) * ((1.0_wp - s) * c - s * d)
      end function turning

      !> The output time that has come
      subroutine write_out()
         do while (history%points < size(history%time))
            if (history%time(history%points + 1) > t) exit
            history%points = history%points + 1
            call body%store_row(t, y, history%loss, history%state(:, history%points))
         end do
      end subroutine write_out

   end subroutine respond_in_modes

end module rocking_modes
