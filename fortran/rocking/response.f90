!> The response of any rocking structure to a ground motion: uplift, rocking, impacts, rest, collapse.
!>
!> One integrator serves blocks, arches and tabulated mechanisms. It stops at every break of the ground motion, so
!> that the order of the method holds; finds impacts on the dense output and polishes them by repeating the step;
!> rests explicitly and looks for re-uplift, because free rocking makes infinitely many impacts in finite time.
module rocking_response
   use common_lists, only : event_collapse => rocking_event_collapse, event_impact => rocking_event_impact, &
      event_peak => rocking_event_peak, event_rest => rocking_event_rest, event_uplift => rocking_event_uplift, &
      outcome_collapse => rocking_outcome_collapse, outcome_no_hinging => rocking_outcome_no_hinging, &
      outcome_recovery => rocking_outcome_recovery
   use common_kinds, only : wp
   use common_cancel, only : cancel_requested
   use common_dense_step, only : dense_step
   use common_dopri5, only : dopri5_attempt, dopri5_factor, step_memory
   use common_signal, only : signal
   use common_status, only : status_ok, status_cancelled, status_out_of_memory, status_too_many_steps, &
      status_step_too_small
   use rocking_crossings, only : impact_fraction, turning_fraction, crossing_fraction
   use rocking_demand, only : demand_at, look_within, look_at_rest
   use rocking_equation, only : equation_of_motion, attempt_step, series_factor, polish_impact
   use rocking_record, only : cannot_reach, energy_of, response_history
   use rocking_rocker, only : rocker, side_index
   use rocking_uplift, only : find_uplift, last_calm
   use rocking_watch, only : joint_demand
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: find_response, response, response_options, response_history

   type :: response_options
      real(wp) :: end_time = 0.0_wp      !! [s]
      real(wp) :: tolerance = 1.0e-8_wp  !! relative, per step
      real(wp) :: start_q = 0.0_wp       !! initial rotation, >= 0 [rad]
      real(wp) :: start_v = 0.0_wp       !! initial rate [rad/s]
      integer :: start_side = 1          !! side of the initial rotation
      integer :: max_steps = 50000000    !! attempts
      !> Stop once the motion is over and the energy left reaches neither the barrier nor past the greatest rotation
      !> so far: the outcome and the peak are then known. For maps and ensembles.
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
      type(joint_demand) :: joints              !! of a structure that is watched
   end type response

   !> Where a run stands: the state of the structure and of the integrator, and the answer so far
   type :: run_state
      type(equation_of_motion) :: problem  !! with the structure, its side, and the segment of the ground motion
      type(response_options) :: options
      type(response) :: answer
      type(response_history), pointer :: history => null()  !! null: only the answer is wanted
      type(dense_step) :: step             !! the last one
      type(step_memory) :: memory
      real(wp) :: t = 0.0_wp               !! [s]
      real(wp) :: q = 0.0_wp               !! rotation, >= 0 [rad]
      real(wp) :: v = 0.0_wp               !! its rate [rad/s]
      real(wp) :: a = 0.0_wp               !! its acceleration [rad/s^2]
      real(wp) :: h_next = 0.0_wp          !! length of the next step [s]
      real(wp) :: atol_q = 0.0_wp
      real(wp) :: atol_v = 0.0_wp
      real(wp) :: look_every = huge(1.0_wp)  !! longest time between two looks at the joints [s]
      integer :: attempts = 0
      integer :: last_whole = 0            !! last segment of the ground motion that ends within the run
      integer(c_int) :: status = status_ok
      logical :: resting = .false.
      logical :: from_rest = .false.       !! no step was accepted since the uplift
      logical :: renew = .true.            !! the acceleration is not that of this state
      logical :: at_hand = .false.         !! the next step was tried already
      logical :: over = .false.            !! nothing more is to be done
   contains
      procedure :: start_state
      procedure :: segment_end
      procedure :: wait_for_uplift
      procedure :: skip_calm
      procedure :: may_glide
      procedure :: glide_samples
      procedure :: take_step
      procedure :: pass_touch
      procedure :: take_impact
      procedure :: take_fall
      procedure :: move_on
      procedure :: past_its_peak
      procedure :: conclude_run
      procedure :: count_attempt
      procedure :: quiet
      procedure :: advance_segment
      procedure :: note_peak
      procedure :: note_turning
      procedure :: leave_mode
      procedure :: hold_at_rest
   end type run_state

   integer, parameter :: poll_every = 2000
   !> Looks at the joints within the natural time of the structure, sqrt(M q_cr / V')
   real(wp), parameter :: looks = 50.0_wp

contains

   !> Rock a structure under a ground motion until collapse, the end time, or an error
   subroutine find_response(body, ground, options, answer, status, history)
      class(rocker), intent(in), target :: body
      type(signal), intent(in) :: ground
      type(response_options), intent(in) :: options
      type(response), intent(out) :: answer
      integer(c_int), intent(out) :: status
      type(response_history), intent(inout), optional, target :: history
      type(run_state) :: run
      real(wp) :: t_next, s
      logical :: accepted, left

      if (present(history)) run%history => history
      call run%start_state(body, ground, options)
      do while (run%t < options%end_time .and. .not. run%over)
         t_next = run%segment_end()
         if (run%resting) then
            call run%wait_for_uplift(t_next)
            if (run%resting .or. run%over) cycle
         end if
         if (run%may_glide(t_next)) then
            call run%glide_samples()
            if (run%t >= options%end_time .or. run%over) cycle
            t_next = run%segment_end()
         end if
         call run%take_step(t_next, accepted)
         if (.not. accepted) cycle
         s = impact_fraction(run%step, run%q, run%v)
         if (allocated(run%problem%memory)) then
            call run%leave_mode(t_next, s, left)
            if (left) cycle
         end if
         if (s > 0.0_wp) then
            if (run%from_rest .and. run%q <= 0.0_wp .and. run%v <= 0.0_wp .and. run%step%q <= 0.0_wp &
               .and. s >= 1.0_wp) then
               call run%pass_touch()
            else
               call run%take_impact(s)
            end if
            cycle
         end if
         s = crossing_fraction(run%step, run%q, run%v, body%limit(side_index(run%problem%side)))
         if (s > 0.0_wp) then
            call run%take_fall(s)
         else
            call run%move_on(t_next)
         end if
      end do
      call run%conclude_run()
      if (present(history)) call move_alloc(run%problem%memory, history%memory)
      answer = run%answer
      status = run%status
   end subroutine find_response

   !> The state at time zero
   subroutine start_state(state, body, ground, options)
      class(run_state), intent(inout) :: state
      class(rocker), intent(in), target :: body
      type(signal), intent(in) :: ground
      type(response_options), intent(in) :: options
      real(wp) :: m, half_dm
      integer :: i, stat
      logical :: closed

      state%options = options
      state%problem%body => body
      state%problem%ground = ground
      state%problem%side = options%start_side
      state%problem%series = body%has_series .and. .not. ground%has_harmonics()
      if (allocated(body%held)) then
         state%problem%series = .false.
         allocate (state%problem%memory(body%held%count), stat=stat)
         if (stat /= 0) then
            state%status = status_out_of_memory
            state%over = .true.
            return
         end if
         call body%held%reset_states(side_index(options%start_side), options%start_q, state%problem%memory)
         if (options%start_q <= 0.0_wp) call state%hold_at_rest()
      end if
      do i = 1, 2
         call body%coefficients(3 - 2 * i, 0.0_wp, m, half_dm, state%problem%rest_dv(i), &
            state%problem%rest_dh(i), closed)
         if (allocated(body%watch)) state%look_every = min(state%look_every, &
            sqrt(m * body%critical(i) / state%problem%rest_dv(i)) / looks)
      end do
      i = side_index(options%start_side)
      state%atol_q = 0.01_wp * options%tolerance * maxval(body%critical)
      state%atol_v = 0.01_wp * options%tolerance * 1.0e3_wp * maxval(body%rest_rate)
      state%q = options%start_q
      state%v = options%start_v
      state%resting = state%q <= 0.0_wp .and. state%v <= 0.0_wp
      if (.not. state%resting) state%answer%half_cycles = 1
      state%h_next = 1.0e-3_wp * sqrt(body%critical(i)) / max(body%rest_rate(i) * 1.0e3_wp, tiny(1.0_wp))
      state%problem%segment = 0
      do while (state%problem%segment <= ground%segments)
         if (ground%break_time(state%problem%segment + 1) > state%t) exit
         state%problem%segment = state%problem%segment + 1
      end do
      state%last_whole = ground%segments
      do while (state%last_whole > 0)
         if (ground%break_time(state%last_whole + 1) <= options%end_time) exit
         state%last_whole = state%last_whole - 1
      end do
      call state%note_peak(state%q)
   end subroutine start_state

   !> Is the ground motion over?
   pure function quiet(state) result(answer)
      class(run_state), intent(in) :: state
      logical :: answer
      answer = state%problem%segment > state%problem%ground%segments
   end function quiet

   !> End of the segment of the ground motion, or of the run [s]
   pure function segment_end(state) result(t_next)
      class(run_state), intent(in) :: state
      real(wp) :: t_next
      t_next = state%options%end_time
      if (.not. state%quiet()) t_next = min(t_next, state%problem%ground%break_time(state%problem%segment + 1))
   end function segment_end

   !> At rest until the ground lifts the structure, or for a while
   subroutine wait_for_uplift(state, t_next)
      class(run_state), intent(inout) :: state
      real(wp), intent(in) :: t_next
      real(wp) :: window, lifts
      integer :: found_side

      call state%count_attempt()
      if (state%over) return
      if (state%quiet()) then
         state%t = state%options%end_time
         if (associated(state%history)) call state%history%fill_rest(state%problem, state%t)
         state%over = .true.
         return
      end if
      ! Long sines are searched in pieces, so that the loop answers a request to stop.
      window = min(t_next, state%t + 64.0_wp * state%problem%ground%shortest_period(state%problem%segment))
      call find_uplift(state%problem, state%t, window, lifts, found_side)
      if (allocated(state%problem%body%watch)) call look_at_rest(state%problem, state%t, lifts, state%answer%joints)
      if (found_side == 0) then
         state%t = window
         if (associated(state%history)) call state%history%fill_rest(state%problem, state%t)
         if (state%t >= t_next .and. state%t < state%options%end_time) state%problem%segment = state%problem%segment + 1
         if (.not. associated(state%history)) call state%skip_calm()
         return
      end if
      if (associated(state%history)) call state%history%fill_rest(state%problem, lifts)
      state%t = lifts
      state%resting = .false.
      state%from_rest = .true.
      state%problem%side = found_side
      state%q = 0.0_wp
      state%v = 0.0_wp
      state%renew = .true.
      call demand_at(state%problem, state%t, state%q, state%v, state%answer%joints)
      state%answer%half_cycles = state%answer%half_cycles + 1
      if (associated(state%history)) call state%history%note_event(event_uplift, state%t, real(found_side, wp))
   end subroutine wait_for_uplift

   !> Over the segments of a sampled motion that leave the structure at rest, where nothing is recorded of them
   subroutine skip_calm(state)
      class(run_state), intent(inout) :: state
      integer :: calm
      associate (problem => state%problem)
         if (.not. associated(problem%ground%samples) .or. problem%segment < 1) return
         if (allocated(problem%body%watch)) then
            if (any(problem%body%watch%slides < huge(1.0_wp)) .and. state%answer%joints%slips_at < 0.0_wp) return
            if (any(problem%body%watch%opens < huge(1.0_wp)) .and. state%answer%joints%leaves_at < 0.0_wp) return
         end if
         calm = last_calm(problem, problem%segment, state%options%end_time)
         if (calm < problem%segment) return
         state%t = problem%ground%break_time(calm + 1)
         problem%segment = calm + 1
      end associate
   end subroutine skip_calm

   !> Does a whole segment of straight lines lie ahead, with nobody asking for what happens within?
   pure function may_glide(state, t_next) result(answer)
      class(run_state), intent(in) :: state
      real(wp), intent(in) :: t_next
      logical :: answer
      associate (problem => state%problem)
         answer = problem%series .and. associated(problem%ground%samples) .and. .not. associated(state%history)
         if (answer) answer = problem%segment >= 1 .and. problem%segment <= state%last_whole
         if (answer) answer = state%t <= problem%ground%break_time(problem%segment) &
            .and. state%h_next >= t_next - state%t
      end associate
   end function may_glide

   !> Over the segments in which nothing happens: what take_step and move_on do, without looking into them
   subroutine glide_samples(state)
      class(run_state), intent(inout) :: state
      integer :: last, passed, polls

      associate (problem => state%problem, ground => state%problem%ground)
         last = min(state%last_whole, problem%segment - 1 + state%options%max_steps - state%attempts)
         call problem%body%glide_samples(problem%side, ground%start, ground%step, ground%scale, ground%samples, &
            problem%segment, last, [state%atol_q, state%atol_v, state%options%tolerance], state%q, state%v, passed, &
            state%step, state%at_hand, state%answer%joints)
         if (passed == 0) return
         problem%segment = problem%segment + passed
         state%t = ground%break_time(problem%segment)
         state%h_next = max(state%h_next, 2.0_wp * (state%t - ground%break_time(problem%segment - 1)))
      end associate
      state%renew = .false.
      state%from_rest = .false.
      state%answer%steps = state%answer%steps + passed
      polls = state%attempts / poll_every
      state%attempts = state%attempts + passed
      if (state%attempts / poll_every > polls) then
         if (cancel_requested()) then
            state%status = status_cancelled
            state%over = .true.
         end if
      end if
      call state%note_peak(state%q)
   end subroutine glide_samples

   !> Try one step of at most the way to t_next; where it is refused the next try is shorter
   subroutine take_step(state, t_next, accepted)
      class(run_state), intent(inout) :: state
      real(wp), intent(in) :: t_next
      logical, intent(out) :: accepted
      real(wp) :: h, remaining, factor

      accepted = .false.
      if (state%renew .and. .not. state%problem%series) state%a = state%problem%acceleration(state%t, state%q, state%v)
      state%renew = .false.
      remaining = t_next - state%t
      ! An error estimate can be blind to a whole cycle of the ground inside one step.
      h = min(state%h_next, 0.125_wp * state%problem%ground%shortest_period(state%problem%segment))
      if (h >= remaining) then
         h = remaining
      else if (h > 0.5_wp * remaining) then
         h = 0.5_wp * remaining
      end if
      call state%count_attempt()
      if (state%over) return
      if (.not. state%at_hand) call attempt_step(state%problem, state%t, h, state%q, state%v, state%a, state%atol_q, &
         state%atol_v, state%options%tolerance, state%step)
      state%at_hand = .false.
      if (state%problem%series) then
         factor = series_factor(state%step)
      else
         call dopri5_factor(state%step%error, state%memory, factor)
      end if
      accepted = state%step%error <= 1.0_wp
      if (accepted) then
         state%answer%steps = state%answer%steps + 1
         state%h_next = max(h * factor, merge(state%h_next, 0.0_wp, h >= remaining .and. factor >= 1.0_wp))
      else
         state%answer%rejected = state%answer%rejected + 1
         state%h_next = h * factor
         if (state%h_next <= 8.0_wp * spacing(max(state%t, 1.0e-3_wp))) then
            state%status = status_step_too_small
            state%over = .true.
         end if
      end if
   end subroutine take_step

   !> The ground only touched the limit: nothing rose
   subroutine pass_touch(state)
      class(run_state), intent(inout) :: state
      state%answer%half_cycles = state%answer%half_cycles - 1
      state%resting = .true.
      state%from_rest = .false.
      state%t = state%t + state%step%h
      if (associated(state%history)) then
         state%history%events = state%history%events - 1
         call state%history%fill_rest(state%problem, state%t)
      end if
      call state%advance_segment()
   end subroutine pass_touch

   !> The hinges close within the step: the other side opens, or the structure rests
   subroutine take_impact(state, fraction)
      class(run_state), intent(inout) :: state
      real(wp), intent(in) :: fraction  !! of the step, to first accuracy
      real(wp) :: v_before
      integer :: i

      call polish_impact(state%problem, state%q, state%v, state%a, state%atol_q, state%atol_v, &
         state%options%tolerance, fraction, state%step)
      call state%note_turning()
      call look_within(state%problem, state%step, state%look_every, 1.0_wp, state%answer%joints)
      if (associated(state%history)) call state%history%cover_step(state%problem, state%step, 1.0_wp)
      state%from_rest = .false.
      state%t = state%step%t + state%step%h
      v_before = min(state%step%v, 0.0_wp)
      state%q = 0.0_wp
      state%v = v_before
      if (associated(state%history)) then
         call state%history%note_event(event_impact, state%t, real(state%problem%side, wp) * v_before)
         call state%history%book_loss(state%problem, -v_before, 1.0_wp)
      end if
      state%answer%impacts = state%answer%impacts + 1
      if (state%problem%body%free(side_index(-state%problem%side))) then
         state%problem%side = -state%problem%side
         i = side_index(state%problem%side)
         state%v = state%problem%body%restitution(i) * (-v_before)
      else
         i = side_index(state%problem%side)
         state%v = state%problem%body%rebound(i) * (-v_before)
      end if
      state%q = 0.0_wp
      if (allocated(state%problem%memory)) call state%problem%body%held%settle_springs(i, 0.0_wp, state%problem%memory)
      if (associated(state%history)) call state%history%book_loss(state%problem, state%v, -1.0_wp)
      if (state%v <= state%problem%body%rest_rate(i)) then
         if (associated(state%history)) call state%history%book_loss(state%problem, state%v, 1.0_wp)
         state%v = 0.0_wp
         state%resting = .true.
         if (allocated(state%problem%memory)) call state%hold_at_rest()
         if (associated(state%history)) call state%history%note_event(event_rest, state%t, 0.0_wp)
         state%over = state%options%stop_when_safe .and. state%quiet()
         if (state%over) return
      else
         state%answer%half_cycles = state%answer%half_cycles + 1
         call demand_at(state%problem, state%t, state%q, state%v, state%answer%joints)
      end if
      state%renew = .true.
      call state%advance_segment()
   end subroutine take_impact

   !> The rotation passes the limit within the step
   subroutine take_fall(state, fraction)
      class(run_state), intent(inout) :: state
      real(wp), intent(in) :: fraction  !! of the step
      real(wp) :: limit
      limit = state%problem%body%limit(side_index(state%problem%side))
      call look_within(state%problem, state%step, state%look_every, fraction, state%answer%joints)
      if (associated(state%history)) call state%history%cover_step(state%problem, state%step, fraction)
      state%t = state%step%t + fraction * state%step%h
      state%answer%outcome = outcome_collapse
      state%answer%stop_time = state%t
      call state%note_peak(limit)
      if (associated(state%history)) then
         call state%history%note_event(event_collapse, state%t, real(state%problem%side, wp) * limit)
      end if
      state%over = .true.
   end subroutine take_fall

   !> An ordinary step: on to its end
   subroutine move_on(state, t_next)
      class(run_state), intent(inout) :: state
      real(wp), intent(in) :: t_next
      logical :: was_quiet, whole
      call state%note_turning()
      call look_within(state%problem, state%step, state%look_every, 1.0_wp, state%answer%joints)
      if (associated(state%history)) call state%history%cover_step(state%problem, state%step, 1.0_wp)
      state%from_rest = .false.
      whole = state%step%h >= t_next - state%t
      state%t = state%step%t + state%step%h
      if (whole) state%t = t_next
      state%q = state%step%q
      state%v = state%step%v
      state%a = state%step%a
      call state%note_peak(state%q)
      if (allocated(state%problem%memory)) call state%problem%body%held%note_forces(side_index(state%problem%side), &
         state%q, state%v, state%problem%memory)
      was_quiet = state%quiet()
      call state%advance_segment()
      if (state%renew) call demand_at(state%problem, state%t, state%q, state%v, state%answer%joints)  ! the ground jumps here
      if (.not. (state%options%stop_when_safe .and. was_quiet .and. state%v <= 0.0_wp)) return
      if (state%q >= state%problem%body%critical(side_index(state%problem%side))) return
      state%over = cannot_reach(state%problem, state%q, state%v, 1.0_wp)
      if (state%over) state%over = state%past_its_peak()
   end subroutine move_on

   !> Is the greatest rotation known, as the energy left after the next impact reaches no further on either side?
   function past_its_peak(state) result(answer)
      class(run_state), intent(in) :: state
      logical :: answer
      real(wp) :: m, m_next, half_dm, dv, dh, energy, kept, reach(2)
      integer :: i
      logical :: closed
      associate (body => state%problem%body, side => state%problem%side, share => min(1.0_wp, state%answer%peak_ratio))
         if (allocated(state%problem%memory)) then
            answer = cannot_reach(state%problem, state%q, state%v, share)
            return
         end if
         energy = energy_of(state%problem, state%q, state%v)
         call body%coefficients(side, 0.0_wp, m, half_dm, dv, dh, closed)
         call body%coefficients(-side, 0.0_wp, m_next, half_dm, dv, dh, closed)
         do i = 1, 2
            reach(i) = body%potential(3 - 2 * i, share * body%critical(i))
         end do
         kept = body%restitution(side_index(-side))**2 * m_next / m
         if (.not. body%free(side_index(-side))) kept = body%rebound(side_index(side))**2
         answer = energy * kept <= minval(reach, mask=body%free)
      end associate
   end function past_its_peak

   !> Outcome and whether it is final
   subroutine conclude_run(state)
      class(run_state), intent(inout) :: state
      if (allocated(state%problem%memory)) call state%problem%body%held%settle_springs(side_index(state%problem%side), &
         merge(0.0_wp, state%q, state%resting), state%problem%memory)
      if (state%answer%outcome == outcome_collapse) return
      state%answer%stop_time = state%t
      if (state%answer%half_cycles > 0) state%answer%outcome = outcome_recovery
      if (state%resting) then
         state%answer%settled = state%status == status_ok
      else
         state%answer%settled = state%quiet() .and. state%q < &
            state%problem%body%critical(side_index(state%problem%side)) &
            .and. cannot_reach(state%problem, state%q, state%v, 1.0_wp)
      end if
   end subroutine conclude_run

   !> Every pass of the loop: the limit of attempts, and now and then the request to stop
   subroutine count_attempt(state)
      class(run_state), intent(inout) :: state
      state%attempts = state%attempts + 1
      if (state%attempts > state%options%max_steps) then
         state%status = status_too_many_steps
      else if (mod(state%attempts, poll_every) == 0) then
         if (cancel_requested()) state%status = status_cancelled
      end if
      state%over = state%status /= status_ok
   end subroutine count_attempt

   !> Go to the next segment when its break is reached; the acceleration is renewed at a jump
   subroutine advance_segment(state)
      class(run_state), intent(inout) :: state
      if (state%quiet()) return
      if (state%t < state%problem%ground%break_time(state%problem%segment + 1)) return
      if (.not. state%problem%ground%smooth_to_next(state%problem%segment)) state%renew = .true.
      state%problem%segment = state%problem%segment + 1
   end subroutine advance_segment

   !> Where a restraint yields, goes slack or takes up again within the step, and before an impact: on to there only
   subroutine leave_mode(state, t_next, impact_at, left)
      class(run_state), intent(inout) :: state
      real(wp), intent(in) :: t_next
      real(wp), intent(in) :: impact_at  !! fraction of the step, 0 where there is none
      logical, intent(out) :: left       !! the step is done with
      real(wp) :: until, fraction, again, h
      integer :: i, which, earlier, k

      i = side_index(state%problem%side)
      until = merge(impact_at, 1.0_wp, impact_at > 0.0_wp)
      call state%problem%body%held%find_leaving(i, state%step, until, state%problem%memory, fraction, which)
      left = which > 0
      if (.not. left) return
      h = fraction * state%step%h
      if (h > 8.0_wp * spacing(state%t)) then
         ! a step that ends there has the order of the integrator, which its polynomial has not
         do k = 1, 4
            call dopri5_attempt(state%problem, state%t, h, state%q, state%v, state%a, state%atol_q, state%atol_v, &
               state%options%tolerance, state%step)
            call state%problem%body%held%find_leaving(i, state%step, 1.0_wp, state%problem%memory, again, earlier)
            if (earlier == 0) exit
            which = earlier
            if (again >= 1.0_wp - 1.0e-12_wp) exit
            h = again * h
         end do
         if (state%step%q > 0.0_wp .or. state%q > 0.0_wp) call state%move_on(t_next)
      end if
      call state%problem%body%held%change_mode(i, state%q, which, state%problem%memory)
      state%renew = .true.
   end subroutine leave_mode

   !> The moments of restraints while the structure rests
   subroutine hold_at_rest(state)
      class(run_state), intent(inout) :: state
      integer :: i
      call state%problem%body%held%settle_springs(1, 0.0_wp, state%problem%memory)
      do i = 1, 2
         state%problem%rest_hold(i) = state%problem%body%held%moment(i, 0.0_wp, 0.0_wp, state%problem%memory)
      end do
   end subroutine hold_at_rest

   !> Keep the rotation of greatest size
   subroutine note_peak(state, rotation)
      class(run_state), intent(inout) :: state
      real(wp), intent(in) :: rotation
      real(wp) :: ratio
      ratio = rotation / state%problem%body%critical(side_index(state%problem%side))
      if (ratio > state%answer%peak_ratio) then
         state%answer%peak_ratio = ratio
         state%answer%peak = real(state%problem%side, wp) * rotation
      end if
   end subroutine note_peak

   !> A turning point inside the step is a peak of the rotation
   subroutine note_turning(state)
      class(run_state), intent(inout) :: state
      real(wp) :: turned
      if (.not. (state%v > 0.0_wp .and. state%step%v <= 0.0_wp)) return
      turned = turning_fraction(state%step)
      if (allocated(state%problem%memory)) call state%problem%body%held%note_forces(side_index(state%problem%side), &
         state%step%coordinate(turned), 0.0_wp, state%problem%memory)
      call state%note_peak(state%step%coordinate(turned))
      if (associated(state%history)) call state%history%note_event(event_peak, state%step%t + turned * state%step%h, &
         real(state%problem%side, wp) * state%step%coordinate(turned))
   end subroutine note_turning

end module rocking_response
