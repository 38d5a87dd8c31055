!> The response of any rocking structure to a ground motion: uplift, rocking, impacts, rest, collapse.
!>
!> One integrator serves blocks, arches and tabulated mechanisms. It stops at every break of the ground motion, so
!> that the order of the method holds; finds impacts on the dense output and polishes them by repeating the step;
!> rests explicitly and looks for re-uplift, because free rocking makes infinitely many impacts in finite time.
module rocking_response
   use common_kinds, only : wp
   use common_cancel, only : cancel_requested
   use common_dense_step, only : dense_step
   use common_dopri5, only : dopri5_factor, step_memory
   use common_signal, only : signal
   use common_status, only : status_ok, status_cancelled, status_too_many_steps, status_step_too_small
   use rocking_crossings, only : impact_fraction, turning_fraction, crossing_fraction
   use rocking_equation, only : equation_of_motion, attempt, series_factor, polish_impact
   use rocking_record, only : barrier_of, energy_of, event_collapse, event_impact, event_peak, event_rest, &
      event_uplift, response_history
   use rocking_rocker, only : rocker, side_index
   use rocking_uplift, only : find_uplift
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: respond, response, response_options, response_history
   public :: outcome_no_hinging, outcome_recovery, outcome_collapse
   public :: event_uplift, event_impact, event_peak, event_rest, event_collapse

   integer(c_int), parameter :: outcome_no_hinging = 0, outcome_recovery = 1, outcome_collapse = 2

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
      integer :: attempts = 0
      integer(c_int) :: status = status_ok
      logical :: resting = .false.
      logical :: from_rest = .false.       !! no step was accepted since the uplift
      logical :: renew = .true.            !! the acceleration is not that of this state
      logical :: over = .false.            !! nothing more is to be done
   contains
      procedure :: start
      procedure :: segment_end
      procedure :: wait
      procedure :: take_step
      procedure :: touch
      procedure :: impact
      procedure :: fall
      procedure :: move_on
      procedure :: conclude
      procedure :: count_attempt
      procedure :: quiet
      procedure :: advance_segment
      procedure :: note_peak
      procedure :: note_turning
   end type run_state

   integer, parameter :: poll_every = 2000

contains

   !> Rock a structure under a ground motion until collapse, the end time, or an error
   subroutine respond(body, ground, options, answer, status, history)
      class(rocker), intent(in), target :: body
      type(signal), intent(in) :: ground
      type(response_options), intent(in) :: options
      type(response), intent(out) :: answer
      integer(c_int), intent(out) :: status
      type(response_history), intent(inout), optional, target :: history
      type(run_state) :: run
      real(wp) :: t_next, s
      logical :: accepted

      if (present(history)) run%history => history
      call run%start(body, ground, options)
      do while (run%t < options%end_time .and. .not. run%over)
         t_next = run%segment_end()
         if (run%resting) then
            call run%wait(t_next)
            if (run%resting .or. run%over) cycle
         end if
         call run%take_step(t_next, accepted)
         if (.not. accepted) cycle
         s = impact_fraction(run%step, run%q, run%v)
         if (s > 0.0_wp) then
            if (run%from_rest .and. run%q <= 0.0_wp .and. run%v <= 0.0_wp .and. run%step%q <= 0.0_wp &
               .and. s >= 1.0_wp) then
               call run%touch()
            else
               call run%impact(s)
            end if
         else if (run%step%q >= body%limit(side_index(run%problem%side))) then
            call run%fall()
         else
            call run%move_on(t_next)
         end if
      end do
      call run%conclude()
      answer = run%answer
      status = run%status
   end subroutine respond

   !> The state at time zero
   subroutine start(self, body, ground, options)
      class(run_state), intent(inout) :: self
      class(rocker), intent(in), target :: body
      type(signal), intent(in) :: ground
      type(response_options), intent(in) :: options
      real(wp) :: m, half_dm
      integer :: i
      logical :: closed

      self%options = options
      self%problem%body => body
      self%problem%ground = ground
      self%problem%side = options%start_side
      self%problem%series = body%has_series .and. .not. ground%has_harmonics()
      do i = 1, 2
         call body%coefficients(3 - 2 * i, 0.0_wp, m, half_dm, self%problem%rest_dv(i), self%problem%rest_dh(i), closed)
      end do
      i = side_index(options%start_side)
      self%atol_q = 0.01_wp * options%tolerance * maxval(body%critical)
      self%atol_v = 0.01_wp * options%tolerance * 1.0e3_wp * maxval(body%rest_rate)
      self%q = options%start_q
      self%v = options%start_v
      self%resting = self%q <= 0.0_wp .and. self%v <= 0.0_wp
      if (.not. self%resting) self%answer%half_cycles = 1
      self%h_next = 1.0e-3_wp * sqrt(body%critical(i)) / max(body%rest_rate(i) * 1.0e3_wp, tiny(1.0_wp))
      self%problem%segment = 0
      do while (self%problem%segment <= ground%segments)
         if (ground%break_time(self%problem%segment + 1) > self%t) exit
         self%problem%segment = self%problem%segment + 1
      end do
      call self%note_peak(self%q)
   end subroutine start

   !> Is the ground motion over?
   pure function quiet(self) result(answer)
      class(run_state), intent(in) :: self
      logical :: answer
      answer = self%problem%segment > self%problem%ground%segments
   end function quiet

   !> End of the segment of the ground motion, or of the run [s]
   pure function segment_end(self) result(t_next)
      class(run_state), intent(in) :: self
      real(wp) :: t_next
      t_next = self%options%end_time
      if (.not. self%quiet()) t_next = min(t_next, self%problem%ground%break_time(self%problem%segment + 1))
   end function segment_end

   !> At rest until the ground lifts the structure, or for a while
   subroutine wait(self, t_next)
      class(run_state), intent(inout) :: self
      real(wp), intent(in) :: t_next
      real(wp) :: window, lifts
      integer :: found_side

      call self%count_attempt()
      if (self%over) return
      if (self%quiet()) then
         self%t = self%options%end_time
         if (associated(self%history)) call self%history%rest(self%problem, self%t)
         self%over = .true.
         return
      end if
      ! Long sines are searched in pieces, so that the loop answers a request to stop.
      window = min(t_next, self%t + 64.0_wp * self%problem%ground%shortest_period(self%problem%segment))
      call find_uplift(self%problem, self%t, window, lifts, found_side)
      if (found_side == 0) then
         self%t = window
         if (associated(self%history)) call self%history%rest(self%problem, self%t)
         if (self%t >= t_next .and. self%t < self%options%end_time) self%problem%segment = self%problem%segment + 1
         return
      end if
      if (associated(self%history)) call self%history%rest(self%problem, lifts)
      self%t = lifts
      self%resting = .false.
      self%from_rest = .true.
      self%problem%side = found_side
      self%q = 0.0_wp
      self%v = 0.0_wp
      self%renew = .true.
      self%answer%half_cycles = self%answer%half_cycles + 1
      if (associated(self%history)) call self%history%note(event_uplift, self%t, real(found_side, wp))
   end subroutine wait

   !> Try one step of at most the way to t_next; where it is refused the next try is shorter
   subroutine take_step(self, t_next, accepted)
      class(run_state), intent(inout) :: self
      real(wp), intent(in) :: t_next
      logical, intent(out) :: accepted
      real(wp) :: h, remaining, factor

      accepted = .false.
      if (self%renew .and. .not. self%problem%series) self%a = self%problem%acceleration(self%t, self%q, self%v)
      self%renew = .false.
      remaining = t_next - self%t
      ! An error estimate can be blind to a whole cycle of the ground inside one step.
      h = min(self%h_next, 0.125_wp * self%problem%ground%shortest_period(self%problem%segment))
      if (h >= remaining) then
         h = remaining
      else if (h > 0.5_wp * remaining) then
         h = 0.5_wp * remaining
      end if
      call self%count_attempt()
      if (self%over) return
      call attempt(self%problem, self%t, h, self%q, self%v, self%a, self%atol_q, self%atol_v, &
         self%options%tolerance, self%step)
      if (self%problem%series) then
         factor = series_factor(self%step)
      else
         call dopri5_factor(self%step%error, self%memory, factor)
      end if
      accepted = self%step%error <= 1.0_wp
      if (accepted) then
         self%answer%steps = self%answer%steps + 1
         self%h_next = max(h * factor, merge(self%h_next, 0.0_wp, h >= remaining .and. factor >= 1.0_wp))
      else
         self%answer%rejected = self%answer%rejected + 1
         self%h_next = h * factor
         if (self%h_next <= 8.0_wp * spacing(max(self%t, 1.0e-3_wp))) then
            self%status = status_step_too_small
            self%over = .true.
         end if
      end if
   end subroutine take_step

   !> The ground only touched the limit: nothing rose
   subroutine touch(self)
      class(run_state), intent(inout) :: self
      self%answer%half_cycles = self%answer%half_cycles - 1
      self%resting = .true.
      self%from_rest = .false.
      self%t = self%t + self%step%h
      if (associated(self%history)) then
         self%history%events = self%history%events - 1
         call self%history%rest(self%problem, self%t)
      end if
      call self%advance_segment()
   end subroutine touch

   !> The hinges close within the step: the other side opens, or the structure rests
   subroutine impact(self, fraction)
      class(run_state), intent(inout) :: self
      real(wp), intent(in) :: fraction  !! of the step, to first accuracy
      real(wp) :: v_before
      integer :: i

      call polish_impact(self%problem, self%q, self%v, self%a, self%atol_q, self%atol_v, self%options%tolerance, &
         fraction, self%step)
      call self%note_turning()
      if (associated(self%history)) call self%history%cover(self%problem, self%step, 1.0_wp)
      self%from_rest = .false.
      self%t = self%step%t + self%step%h
      v_before = min(self%step%v, 0.0_wp)
      if (associated(self%history)) then
         call self%history%note(event_impact, self%t, real(self%problem%side, wp) * v_before)
         call self%history%lose(self%problem, -v_before, 1.0_wp)
      end if
      self%answer%impacts = self%answer%impacts + 1
      self%problem%side = -self%problem%side
      i = side_index(self%problem%side)
      self%q = 0.0_wp
      self%v = self%problem%body%restitution(i) * (-v_before)
      if (associated(self%history)) call self%history%lose(self%problem, self%v, -1.0_wp)
      if (self%v <= self%problem%body%rest_rate(i)) then
         if (associated(self%history)) call self%history%lose(self%problem, self%v, 1.0_wp)
         self%v = 0.0_wp
         self%resting = .true.
         if (associated(self%history)) call self%history%note(event_rest, self%t, 0.0_wp)
         self%over = self%options%stop_when_safe .and. self%quiet()
         if (self%over) return
      else
         self%answer%half_cycles = self%answer%half_cycles + 1
      end if
      self%renew = .true.
      call self%advance_segment()
   end subroutine impact

   !> The rotation passes the limit within the step
   subroutine fall(self)
      class(run_state), intent(inout) :: self
      real(wp) :: s, limit
      limit = self%problem%body%limit(side_index(self%problem%side))
      s = crossing_fraction(self%step, limit)
      if (associated(self%history)) call self%history%cover(self%problem, self%step, s)
      self%t = self%step%t + s * self%step%h
      self%answer%outcome = outcome_collapse
      self%answer%stop_time = self%t
      call self%note_peak(limit)
      if (associated(self%history)) then
         call self%history%note(event_collapse, self%t, real(self%problem%side, wp) * limit)
      end if
      self%over = .true.
   end subroutine fall

   !> An ordinary step: on to its end
   subroutine move_on(self, t_next)
      class(run_state), intent(inout) :: self
      real(wp), intent(in) :: t_next
      logical :: was_quiet, whole
      call self%note_turning()
      if (associated(self%history)) call self%history%cover(self%problem, self%step, 1.0_wp)
      self%from_rest = .false.
      whole = self%step%h >= t_next - self%t
      self%t = self%step%t + self%step%h
      if (whole) self%t = t_next
      self%q = self%step%q
      self%v = self%step%v
      self%a = self%step%a
      call self%note_peak(self%q)
      was_quiet = self%quiet()
      call self%advance_segment()
      if (.not. (self%options%stop_when_safe .and. was_quiet .and. self%v <= 0.0_wp)) return
      if (self%q >= self%problem%body%critical(side_index(self%problem%side))) return
      self%over = energy_of(self%problem, self%q, self%v) < barrier_of(self%problem)
   end subroutine move_on

   !> Outcome and whether it is final
   subroutine conclude(self)
      class(run_state), intent(inout) :: self
      if (self%answer%outcome == outcome_collapse) return
      self%answer%stop_time = self%t
      if (self%answer%half_cycles > 0) self%answer%outcome = outcome_recovery
      if (self%resting) then
         self%answer%settled = self%status == status_ok
      else
         self%answer%settled = self%quiet() .and. self%q < self%problem%body%critical(side_index(self%problem%side)) &
            .and. energy_of(self%problem, self%q, self%v) < barrier_of(self%problem)
      end if
   end subroutine conclude

   !> Every pass of the loop: the limit of attempts, and now and then the request to stop
   subroutine count_attempt(self)
      class(run_state), intent(inout) :: self
      self%attempts = self%attempts + 1
      if (self%attempts > self%options%max_steps) then
         self%status = status_too_many_steps
      else if (mod(self%attempts, poll_every) == 0) then
         if (cancel_requested()) self%status = status_cancelled
      end if
      self%over = self%status /= status_ok
   end subroutine count_attempt

   !> Go to the next segment when its break is reached; the acceleration is renewed at a jump
   subroutine advance_segment(self)
      class(run_state), intent(inout) :: self
      if (self%quiet()) return
      if (self%t < self%problem%ground%break_time(self%problem%segment + 1)) return
      if (.not. self%problem%ground%smooth_to_next(self%problem%segment)) self%renew = .true.
      self%problem%segment = self%problem%segment + 1
   end subroutine advance_segment

   !> Keep the rotation of greatest size
   subroutine note_peak(self, rotation)
      class(run_state), intent(inout) :: self
      real(wp), intent(in) :: rotation
      real(wp) :: ratio
      ratio = rotation / self%problem%body%critical(side_index(self%problem%side))
      if (ratio > self%answer%peak_ratio) then
         self%answer%peak_ratio = ratio
         self%answer%peak = real(self%problem%side, wp) * rotation
      end if
   end subroutine note_peak

   !> A turning point inside the step is a peak of the rotation
   subroutine note_turning(self)
      class(run_state), intent(inout) :: self
      real(wp) :: turned
      if (.not. (self%v > 0.0_wp .and. self%step%v <= 0.0_wp)) return
      turned = turning_fraction(self%step)
      call self%note_peak(self%step%coordinate(turned))
      if (associated(self%history)) call self%history%note(event_peak, self%step%t + turned * self%step%h, &
         real(self%problem%side, wp) * self%step%coordinate(turned))
   end subroutine note_turning

end module rocking_response
