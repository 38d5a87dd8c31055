!> The response of any rocking structure to a ground motion: uplift, rocking, impacts, rest, collapse.
!>
!> One integrator serves blocks and arches. It stops at every break of the ground motion, so that
!> the order of the method holds; finds impacts on the dense output and polishes them by repeating
!> the step; rests explicitly and looks for re-uplift, because free rocking makes infinitely many
!> impacts in finite time.
module rocking_response
   use common_kinds, only : wp, gravity
   use common_cancel, only : cancel_requested
   use common_dense_step, only : dense_step
   use common_dopri5, only : oscillator, dopri5_attempt, dopri5_factor, step_memory
   use common_signal, only : signal
   use common_status, only : status_ok, status_cancelled, status_too_many_steps, status_step_too_small
   use rocking_rocker, only : rocker, side_index
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: respond, response, response_options, response_history
   public :: outcome_no_hinging, outcome_recovery, outcome_collapse
   public :: event_uplift, event_impact, event_peak, event_rest, event_collapse

   integer(c_int), parameter :: outcome_no_hinging = 0, outcome_recovery = 1, outcome_collapse = 2
   integer(c_int), parameter :: event_uplift = 1, event_impact = 2, event_peak = 3, event_rest = 4, event_collapse = 5

   type :: response_options
      real(wp) :: end_time = 0.0_wp      !! [s]
      real(wp) :: tolerance = 1.0e-8_wp  !! relative, per step
      real(wp) :: start_q = 0.0_wp       !! initial rotation, >= 0 [rad]
      real(wp) :: start_v = 0.0_wp       !! initial rate [rad/s]
      integer :: start_side = 1          !! side of the initial rotation
      integer :: max_steps = 50000000    !! attempts
      !> Stop once the motion is over and the energy left cannot reach the barrier: the outcome and
      !> the peak are then known. For maps and ensembles.
      logical :: stop_when_safe = .false.
   end type response_options

   type :: response
      integer(c_int) :: outcome = outcome_no_hinging
      integer(c_int) :: half_cycles = 0         !! begun: one per uplift and per impact
      integer(c_int) :: impacts = 0
      real(wp) :: peak = 0.0_wp                 !! rotation of greatest size, positive to +x [rad]
      real(wp) :: peak_ratio = 0.0_wp           !! greatest |rotation| over the critical one
      real(wp) :: stop_time = 0.0_wp            !! collapse, or the time reached [s]
      integer(c_int) :: steps = 0               !! accepted
      integer(c_int) :: rejected = 0
      !> False where the run ended while the structure could still come to rest or to fall
      logical :: settled = .true.
   end type response

   !> What is recorded besides the outcome, in the caller's arrays
   type :: response_history
      integer :: points = 0                        !! output times filled so far
      real(wp), pointer, contiguous :: time(:) => null()      !! asked for, ascending [s]
      !> (8, points): rotation, rate, acceleration, ground horizontal and vertical,
      !> kinetic and potential energy, energy put in minus energy lost at impacts
      real(wp), pointer, contiguous :: state(:, :) => null()
      integer :: events = 0                        !! found, also past the room for them
      integer(c_int), pointer, contiguous :: event_kind(:) => null()
      !> (2, room): time [s]; rotation at a peak or collapse [rad], rate before an impact [rad/s],
      !> both positive to +x; side at an uplift
      real(wp), pointer, contiguous :: event(:, :) => null()
      real(wp) :: work = 0.0_wp                    !! energy put in by the ground [J]
      real(wp) :: loss = 0.0_wp                    !! energy lost at impacts [J]
   end type response_history

   !> Equation of motion on one side during one segment of the ground motion
   type, extends(oscillator) :: rocking_problem
      class(rocker), pointer :: body => null()
      type(signal) :: ground
      integer :: segment = 0
      integer :: side = 1
      logical :: series = .false.  !! the structure solves its own steps
      real(wp) :: rest_dv(2) = 0.0_wp  !! V' at rest, both sides
      real(wp) :: rest_dh(2) = 0.0_wp  !! H at rest, both sides
   contains
      procedure :: acceleration
   end type rocking_problem

   integer, parameter :: poll_every = 2000

contains

   function acceleration(self, t, q, v) result(a)
      class(rocking_problem), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: q
      real(wp), intent(in) :: v
      real(wp) :: a
      real(wp) :: m, half_dm, dv, dh, horizontal, vertical
      logical :: closed

      call self%body%coefficients(self%side, q, m, half_dm, dv, dh, closed)
      if (.not. closed) then
         a = huge(a)  ! the error test refuses the step
         return
      end if
      call self%ground%value_at(self%segment, t, horizontal, vertical)
      a = -(half_dm * v * v + dv * (1.0_wp + vertical / gravity) + real(self%side, wp) * horizontal * dh) / m
   end function acceleration

   !> Rock a structure under a ground motion until collapse, the end time, or an error
   subroutine respond(body, ground, options, answer, status, history)
      class(rocker), intent(in), target :: body
      type(signal), intent(in) :: ground
      type(response_options), intent(in) :: options
      type(response), intent(out) :: answer
      integer(c_int), intent(out) :: status
      type(response_history), intent(inout), optional :: history
      type(rocking_problem) :: problem
      type(dense_step) :: step
      type(step_memory) :: memory
      real(wp) :: t, t_next, window, q, v, a, h, h_next, remaining, factor, s, v_before, energy
      real(wp) :: atol_q, atol_v, m, half_dm
      integer :: attempts, found_side, i
      logical :: resting, from_rest, quiet, renew, closed

      problem%body => body
      problem%ground = ground
      problem%side = options%start_side
      problem%series = body%has_series .and. .not. ground%has_harmonics()
      do i = 1, 2
         call body%coefficients(3 - 2 * i, 0.0_wp, m, half_dm, problem%rest_dv(i), problem%rest_dh(i), closed)
      end do
      i = side_index(problem%side)
      atol_q = 0.01_wp * options%tolerance * maxval(body%critical)
      atol_v = 0.01_wp * options%tolerance * 1.0e3_wp * maxval(body%rest_rate)
      t = 0.0_wp
      q = options%start_q
      v = options%start_v
      resting = q <= 0.0_wp .and. v <= 0.0_wp
      from_rest = .false.
      if (.not. resting) call begin_half_cycle()
      h_next = 1.0e-3_wp * sqrt(body%critical(i)) / max(body%rest_rate(i) * 1.0e3_wp, tiny(1.0_wp))
      problem%segment = 0
      do while (problem%segment <= ground%segments)
         if (ground%break_time(problem%segment + 1) > t) exit
         problem%segment = problem%segment + 1
      end do
      status = status_ok
      attempts = 0
      renew = .true.
      a = 0.0_wp
      call note_peak(q)

      do while (t < options%end_time)
         quiet = problem%segment > ground%segments
         t_next = options%end_time
         if (.not. quiet) t_next = min(t_next, ground%break_time(problem%segment + 1))

         if (resting) then
            call count_attempt()
            if (status /= status_ok) exit
            if (quiet) then
               t = options%end_time
               call record_rest(t)
               exit
            end if
            ! Long sines are searched in pieces, so that the loop answers a request to stop.
            window = min(t_next, t + 64.0_wp * ground%shortest_period(problem%segment))
            call find_uplift(problem, t, window, s, found_side)
            if (found_side == 0) then
               t = window
               call record_rest(t)
               if (t >= t_next .and. t < options%end_time) problem%segment = problem%segment + 1
               cycle
            end if
            call record_rest(s)
            t = s
            resting = .false.
            from_rest = .true.
            problem%side = found_side
            i = side_index(found_side)
            q = 0.0_wp
            v = 0.0_wp
            renew = .true.
            call begin_half_cycle()
            call note_event(event_uplift, t, real(found_side, wp))
         end if

         if (renew .and. .not. problem%series) a = problem%acceleration(t, q, v)
         renew = .false.
         remaining = t_next - t
         ! An error estimate can be blind to a whole cycle of the ground inside one step.
         h = min(h_next, 0.125_wp * ground%shortest_period(problem%segment))
         if (h >= remaining) then
            h = remaining
         else if (h > 0.5_wp * remaining) then
            h = 0.5_wp * remaining
         end if
         call count_attempt()
         if (status /= status_ok) exit
         call attempt(problem, t, h, q, v, a, atol_q, atol_v, options%tolerance, step)
         if (problem%series) then
            factor = series_factor(step)
         else
            call dopri5_factor(step%error, memory, factor)
         end if
         if (.not. step%error <= 1.0_wp) then
            answer%rejected = answer%rejected + 1
            h_next = h * factor
            if (h_next <= 8.0_wp * spacing(max(t, 1.0e-3_wp))) then
               status = status_step_too_small
               exit
            end if
            cycle
         end if
         answer%steps = answer%steps + 1
         h_next = max(h * factor, merge(h_next, 0.0_wp, h >= remaining .and. factor >= 1.0_wp))

         s = impact_fraction(step, q, v)
         if (s > 0.0_wp) then
            if (from_rest .and. q <= 0.0_wp .and. v <= 0.0_wp .and. step%q <= 0.0_wp .and. s >= 1.0_wp) then
               ! The ground only touched the limit: nothing rose.
               answer%half_cycles = answer%half_cycles - 1
               if (present(history)) history%events = history%events - 1
               resting = .true.
               from_rest = .false.
               t = t + step%h
               call record_rest(t)
               call advance_segment()
               cycle
            end if
            call polish_impact(problem, q, v, a, atol_q, atol_v, options%tolerance, s, step)
            call note_turning(step, v)
            call record_moving(step, 1.0_wp)
            from_rest = .false.
            t = step%t + step%h
            v_before = min(step%v, 0.0_wp)
            call note_event(event_impact, t, real(problem%side, wp) * v_before)
            answer%impacts = answer%impacts + 1
            q = 0.0_wp
            v = -v_before
            call lose(v)
            problem%side = -problem%side
            i = side_index(problem%side)
            v = body%restitution(i) * v
            call gain(v)
            if (v <= body%rest_rate(i)) then
               call lose(v)
               v = 0.0_wp
               resting = .true.
               call note_event(event_rest, t, 0.0_wp)
               if (options%stop_when_safe .and. quiet) exit
            else
               call begin_half_cycle()
            end if
            renew = .true.
            call advance_segment()
            cycle
         end if

         if (step%q >= body%limit(i)) then
            s = crossing_fraction(step, body%limit(i))
            call record_moving(step, s)
            t = step%t + s * step%h
            answer%outcome = outcome_collapse
            answer%stop_time = t
            call note_peak(body%limit(i))
            call note_event(event_collapse, t, real(problem%side, wp) * body%limit(i))
            exit
         end if

         call note_turning(step, v)
         call record_moving(step, 1.0_wp)
         from_rest = .false.
         t = step%t + step%h
         if (h >= remaining) t = t_next
         q = step%q
         v = step%v
         a = step%a
         call note_peak(q)
         call advance_segment()
         if (options%stop_when_safe .and. quiet .and. v <= 0.0_wp) then
            if (q < body%critical(i)) then
               call body_energy(q, v, energy)
               if (energy < minval_barrier()) exit
            end if
         end if
      end do

      if (answer%outcome /= outcome_collapse) then
         answer%stop_time = t
         if (answer%half_cycles > 0) answer%outcome = outcome_recovery
         if (.not. resting) then
            call body_energy(q, v, energy)
            answer%settled = problem%segment > ground%segments .and. q < body%critical(i) &
               .and. energy < minval_barrier()
         else
            answer%settled = status == status_ok
         end if
      end if

   contains

      !> Every pass of the loop: the limit of attempts, and now and then the request to stop
      subroutine count_attempt()
         attempts = attempts + 1
         if (attempts > options%max_steps) then
            status = status_too_many_steps
         else if (mod(attempts, poll_every) == 0) then
            if (cancel_requested()) status = status_cancelled
         end if
      end subroutine count_attempt

      subroutine begin_half_cycle()
         answer%half_cycles = answer%half_cycles + 1
      end subroutine begin_half_cycle

      !> Go to the next segment when its break is reached; the acceleration is renewed at a jump
      subroutine advance_segment()
         if (problem%segment > ground%segments) return
         if (t < ground%break_time(problem%segment + 1)) return
         if (.not. ground%smooth_to_next(problem%segment)) renew = .true.
         problem%segment = problem%segment + 1
      end subroutine advance_segment

      subroutine note_peak(rotation)
         real(wp), intent(in) :: rotation
         if (rotation / body%critical(i) > answer%peak_ratio) then
            answer%peak_ratio = rotation / body%critical(i)
            answer%peak = real(problem%side, wp) * rotation
         end if
      end subroutine note_peak

      !> A turning point inside the step is a peak of the rotation
      subroutine note_turning(done, rate_before)
         type(dense_step), intent(in) :: done
         real(wp), intent(in) :: rate_before
         real(wp) :: where_turned
         if (.not. (rate_before > 0.0_wp .and. done%v <= 0.0_wp)) return
         where_turned = turning_fraction(done)
         call note_peak(done%coordinate(where_turned))
         call note_event(event_peak, done%t + where_turned * done%h, &
            real(problem%side, wp) * done%coordinate(where_turned))
      end subroutine note_turning

      subroutine note_event(kind, when, value)
         integer(c_int), intent(in) :: kind
         real(wp), intent(in) :: when
         real(wp), intent(in) :: value
         if (.not. present(history)) return
         history%events = history%events + 1
         if (history%events > size(history%event_kind)) return
         history%event_kind(history%events) = kind
         history%event(:, history%events) = [when, value]
      end subroutine note_event

      !> Kinetic plus potential energy
      subroutine body_energy(rotation, rate, energy)
         real(wp), intent(in) :: rotation
         real(wp), intent(in) :: rate
         real(wp), intent(out) :: energy
         real(wp) :: m, half_dm, dv, dh
         logical :: closed
         call body%coefficients(problem%side, rotation, m, half_dm, dv, dh, closed)
         energy = 0.5_wp * m * rate**2 + body%potential(problem%side, rotation)
      end subroutine body_energy

      function minval_barrier() result(energy)
         real(wp) :: energy
         energy = min(body%potential(1, body%critical(1)), body%potential(-1, body%critical(2)))
      end function minval_barrier

      subroutine lose(rate)
         real(wp), intent(in) :: rate
         real(wp) :: energy
         if (.not. present(history)) return
         call body_energy(0.0_wp, rate, energy)
         history%loss = history%loss + energy
      end subroutine lose

      subroutine gain(rate)
         real(wp), intent(in) :: rate
         real(wp) :: energy
         if (.not. present(history)) return
         call body_energy(0.0_wp, rate, energy)
         history%loss = history%loss - energy
      end subroutine gain

      !> Work of the ground over the first part of a step, by three Gauss points on the dense output
      !> (thesis Eq. 6.4)
      function work_of(done, fraction) result(work)
         type(dense_step), intent(in) :: done
         real(wp), intent(in) :: fraction
         real(wp) :: work
         real(wp), parameter :: node(3) = [0.1127016653792583_wp, 0.5_wp, 0.8872983346207417_wp]
         real(wp), parameter :: weight(3) = [5.0_wp, 8.0_wp, 5.0_wp] / 18.0_wp
         real(wp) :: m, half_dm, dv, dh, horizontal, vertical, x
         logical :: closed
         integer :: j
         work = 0.0_wp
         do j = 1, 3
            x = fraction * node(j)
            call body%coefficients(problem%side, done%coordinate(x), m, half_dm, dv, dh, closed)
            call ground%value_at(problem%segment, done%t + x * done%h, horizontal, vertical)
            work = work - weight(j) * fraction * done%h * done%rate(x) &
               * (real(problem%side, wp) * horizontal * dh + dv * vertical / gravity)
         end do
      end function work_of

      !> Fill the output times that the first part of a step covers, and book the work done over it
      subroutine record_moving(done, covered)
         type(dense_step), intent(in) :: done
         real(wp), intent(in) :: covered  !! fraction of the step
         real(wp) :: x, end_time, rotation, rate, horizontal, vertical, energy, potential, sigma
         if (.not. present(history)) return
         sigma = real(problem%side, wp)
         end_time = done%t + covered * done%h
         do while (history%points < size(history%time))
            if (history%time(history%points + 1) > end_time) exit
            history%points = history%points + 1
            x = max(0.0_wp, (history%time(history%points) - done%t) / done%h)
            rotation = max(done%coordinate(x), 0.0_wp)
            rate = done%rate(x)
            call ground%value_at(problem%segment, history%time(history%points), horizontal, vertical)
            call body_energy(rotation, rate, energy)
            potential = body%potential(problem%side, rotation)
            history%state(:, history%points) = [sigma * rotation, sigma * rate, &
               sigma * problem%acceleration(history%time(history%points), rotation, rate), horizontal, vertical, &
               energy - potential, potential, history%work + work_of(done, x) - history%loss]
         end do
         history%work = history%work + work_of(done, covered)
      end subroutine record_moving

      subroutine record_rest(until)
         real(wp), intent(in) :: until
         real(wp) :: horizontal, vertical
         if (.not. present(history)) return
         do while (history%points < size(history%time))
            if (history%time(history%points + 1) > until) exit
            history%points = history%points + 1
            call ground%value_at(problem%segment, history%time(history%points), horizontal, vertical)
            history%state(:, history%points) = 0.0_wp
            history%state(4:5, history%points) = [horizontal, vertical]
            history%state(8, history%points) = history%work - history%loss
         end do
      end subroutine record_rest

   end subroutine respond

   !> One step: by the structure's own series where it has one and the ground runs in straight lines
   subroutine attempt(problem, t, h, q, v, a, atol_q, atol_v, rtol, step)
      type(rocking_problem), intent(in) :: problem
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
   end subroutine attempt

   !> Factor for the next step length after a series: its error grows with the power of the last term
   pure function series_factor(step) result(factor)
      type(dense_step), intent(in) :: step
      real(wp) :: factor
      if (.not. step%error <= huge(1.0_wp)) then
         factor = 0.1_wp
      else if (step%error <= 1.0e-3_wp) then
         factor = 2.0_wp  ! the series was cut short: a longer step is as cheap
      else
         factor = min(2.0_wp, max(0.1_wp, 0.9_wp * step%error**(-1.0_wp / real(step%degree - 2, wp))))
      end if
   end function series_factor

   !> Fraction of the step at which q falls through zero, or 0 where it does not
   pure function impact_fraction(step, q, v) result(s)
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: q  !! at the start
      real(wp), intent(in) :: v  !! at the start
      real(wp) :: s
      real(wp) :: low, high
      integer :: k

      s = 0.0_wp
      high = 1.0_wp
      if (step%q > 0.0_wp) then
         if (.not. (v < 0.0_wp .and. step%v > 0.0_wp)) return
         high = turning_fraction(step)  ! a dip that came back within the step
         if (step%coordinate(high) > 0.0_wp) return
      end if
      low = 0.0_wp
      if (q <= 0.0_wp) then
         ! q/s is positive just after the start; find its last sign change
         low = 1.0_wp
         do k = 1, 40
            low = 0.5_wp * low
            if (step%coordinate(low * high) > 0.0_wp) exit
         end do
         low = low * high
         if (step%coordinate(low) <= 0.0_wp) then
            s = 1.0_wp
            return
         end if
      end if
      s = root_between(step, .false., 0.0_wp, low, high)
   end function impact_fraction

   !> Fraction of the step at which the rate changes sign
   pure function turning_fraction(step) result(s)
      type(dense_step), intent(in) :: step
      real(wp) :: s
      s = root_between(step, .true., 0.0_wp, 0.0_wp, 1.0_wp)
   end function turning_fraction

   !> Fraction of the step at which q rises through a level
   pure function crossing_fraction(step, level) result(s)
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: level
      real(wp) :: s
      s = root_between(step, .false., level, 0.0_wp, 1.0_wp)
   end function crossing_fraction

   !> Where the coordinate, or the rate, passes a level between two fractions on either side of it.
   !>
   !> Regula falsi that halves the value of an end that stays (the Illinois rule): never leaves the
   !> bracket and takes a fifth of the evaluations of bisection. Returns the end beyond the level.
   pure function root_between(step, of_rate, level, start, finish) result(s)
      type(dense_step), intent(in) :: step
      logical, intent(in) :: of_rate     !! the rate, else the coordinate
      real(wp), intent(in) :: level
      real(wp), intent(in) :: start      !! value differs from the level in sign from that at finish
      real(wp), intent(in) :: finish
      real(wp) :: s
      real(wp) :: low, high, f_low, f_high, f, middle
      integer :: k, stayed

      low = start
      high = finish
      f_low = value(low)
      f_high = value(high)
      stayed = 0
      do k = 1, 100
         if (f_high == 0.0_wp .or. abs(high - low) <= 2.0_wp * spacing(high)) exit
         middle = high - f_high * (high - low) / (f_high - f_low)
         if (.not. (middle > low .and. middle < high) .or. mod(k, 8) == 0) middle = 0.5_wp * (low + high)
         if (middle <= low .or. middle >= high) exit
         f = value(middle)
         if ((f > 0.0_wp) .eqv. (f_low > 0.0_wp)) then
            low = middle
            f_low = f
            if (stayed == 1) f_high = 0.5_wp * f_high
            stayed = 1
         else
            high = middle
            f_high = f
            if (stayed == -1) f_low = 0.5_wp * f_low
            stayed = -1
         end if
      end do
      s = high

   contains

      pure function value(x) result(f)
         real(wp), intent(in) :: x
         real(wp) :: f
         if (of_rate) then
            f = step%rate(x) - level
         else
            f = step%coordinate(x) - level
         end if
      end function value

   end function root_between

   !> Repeat the step with its end on the impact: the time then has the order of the integrator
   subroutine polish_impact(problem, q, v, a, atol_q, atol_v, rtol, fraction, step)
      type(rocking_problem), intent(in) :: problem
      real(wp), intent(in) :: q, v, a         !! state at the start of the step
      real(wp), intent(in) :: atol_q, atol_v  !! absolute tolerances
      real(wp), intent(in) :: rtol
      real(wp), intent(in) :: fraction        !! first guess, of the step
      type(dense_step), intent(inout) :: step
      real(wp) :: h, full, change
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
         h = h + change
      end do
   end subroutine polish_impact

   !> First time in [t, t_next] at which the ground lifts the resting structure, and the side it rocks to
   subroutine find_uplift(problem, t, t_next, when, side)
      type(rocking_problem), intent(in) :: problem
      real(wp), intent(in) :: t
      real(wp), intent(in) :: t_next
      real(wp), intent(out) :: when
      integer, intent(out) :: side              !! 0 where it stays at rest
      real(wp) :: t0, t1, f0(2), f1(2), best, root, grid, top, at_top(2)
      integer :: j

      side = 0
      when = t_next
      ! Straight lines are tested at their ends; sines 32 times a cycle, and between where they come near.
      grid = problem%ground%shortest_period(problem%segment) / 32.0_wp
      t1 = t
      f1 = drive(t1)
      do while (t1 < t_next)
         t0 = t1
         f0 = f1
         t1 = min(t_next, t0 + grid)
         f1 = drive(t1)
         best = huge(best)
         do j = 1, 2
            if (f0(j) > 0.0_wp) then
               root = t0
            else if (f1(j) > 0.0_wp) then
               root = crossing(j, t0, t1)
            else
               if (grid >= huge(grid) / 64.0_wp .or. max(f0(j), f1(j)) < -0.02_wp * problem%rest_dv(j)) cycle
               call crest(j, t0, t1, top)
               at_top = drive(top)
               if (at_top(j) <= 0.0_wp) cycle
               root = crossing(j, t0, top)
            end if
            if (root < best) then
               best = root
               side = 3 - 2 * j
            end if
         end do
         if (side /= 0) then
            when = best
            return
         end if
      end do

   contains

      !> Driving minus resisting moment of both sides at rest
      function drive(time) result(f)
         real(wp), intent(in) :: time
         real(wp) :: f(2)
         real(wp) :: horizontal, vertical
         call problem%ground%value_at(problem%segment, time, horizontal, vertical)
         f = [-horizontal, horizontal] * problem%rest_dh - problem%rest_dv * (1.0_wp + vertical / gravity)
      end function drive

      !> Where the drive of side j is greatest between two times, by golden section
      subroutine crest(j, first, last, top)
         integer, intent(in) :: j
         real(wp), intent(in) :: first
         real(wp), intent(in) :: last
         real(wp), intent(out) :: top
         real(wp), parameter :: golden = 0.6180339887498949_wp
         real(wp) :: low, high, x, y, fx(2), fy(2)
         integer :: n
         low = first
         high = last
         do n = 1, 30
            x = high - golden * (high - low)
            y = low + golden * (high - low)
            fx = drive(x)
            fy = drive(y)
            if (fx(j) > fy(j)) then
               high = y
            else
               low = x
            end if
         end do
         top = 0.5_wp * (low + high)
      end subroutine crest

      !> The first time at which side j is driven up, between a quiet and a driven time
      function crossing(j, quiet_time, driven_time) result(root)
         integer, intent(in) :: j
         real(wp), intent(in) :: quiet_time
         real(wp), intent(in) :: driven_time
         real(wp) :: root
         real(wp) :: low, high, middle, f(2)
         integer :: n
         low = quiet_time
         high = driven_time
         do n = 1, 60
            middle = 0.5_wp * (low + high)
            f = drive(middle)
            if (f(j) > 0.0_wp) then
               high = middle
            else
               low = middle
            end if
         end do
         root = high
      end function crossing

   end subroutine find_uplift

end module rocking_response
