!> A run of rigid bodies from rest to its end: settle under gravity, shake, check, record.
module dem_run
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : stop_end => dem_stop_end, stop_blow_up => dem_stop_blow_up, stop_rest => dem_stop_rest, &
      stop_restless => dem_stop_restless, stop_step => dem_stop_step, stop_unsettled => dem_stop_unsettled
   use common_status, only : status_ok, status_cancelled, status_not_finite
   use dem_energy, only : energy_terms, energy_residual, energy_row
   use dem_joint, only : brace_joints, free_mortar
   use dem_jointed, only : jointed_model
   use dem_loading, only : movement_end
   use dem_rigid, only : forget_effort
   use dem_simulation, only : any_step, simulation
   use dem_ties, only : tie_forces
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: run_begin, run_on

   integer, parameter :: steps_between_checks = 64

contains

   !> Settle a model and take the first step of its motion; paused then, unless it cannot run
   subroutine run_begin(run, status)
      class(simulation), intent(inout), target :: run
      integer(c_int), intent(out) :: status
      class(jointed_model), pointer :: model
      type(energy_terms) :: start
      real(wp) :: stable, suitable

      run%record%begun = .true.
      model => run%get_model()
      call run%find_pairs(.true., status)
      if (status /= status_ok) return
      call run%find_stable_step(stable, suitable, status)
      if (status /= status_ok) return
      if (stable < any_step) run%record%critical = stable
      model%step = run%options%step
      if (.not. model%step > 0.0_wp) model%step = suitable
      run%record%least_step = model%step
      if (model%step > stable) run%record%reason = stop_step
      if (run%record%reason /= stop_end) return
      ! What starts moving is displaced from where it was drawn.
      if (run%options%settle_steps > 0) then
         call settle_bodies(run, status)
         if (status /= status_ok .or. run%record%reason /= stop_end) return
         call run%mark_rest()
      end if
      model%shaking = .true.
      call take_exactly(run, 1, status)
      if (status /= status_ok) return
      start = run%measure_energy()
      run%record%start = start
      call record_point(run, start)
      run%record%paused = .true.
   end subroutine run_begin

   !> Rest under gravity; time begins then
   subroutine settle_bodies(run, status)
      class(simulation), intent(inout), target :: run
      integer(c_int), intent(out) :: status
      class(jointed_model), pointer :: model
      logical :: rests
      model => run%get_model()
      model%shaking = .false.
      if (model%rigid%setting%used) then
         call rest_by_waiting(run, rests, status)
      else
         call rest_with_mortar(run, rests, status)
      end if
      if (status /= status_ok) return
      if (.not. rests) then
         run%record%reason = merge(stop_restless, stop_unsettled, run%record%reason == stop_end)
         if (run%record%blamed(1) == 0) run%record%blamed(1) = run%find_least_balanced()
      end if
      call run%forget_settling()
      if (rests) call forget_effort(model%rigid)
      model%t = 0.0_wp
      model%drift = 0.0_wp
      model%steps = 0
   end subroutine settle_bodies

   !> Rest on springs, damped as much as rest needs, whatever the damping of the motion. Mortar does not break while the
   !> weight comes, which comes at once and overshoots; then joints that cannot carry the weight at rest break, and all comes
   !> to rest anew.
   subroutine rest_with_mortar(run, rests, status)
      class(simulation), intent(inout), target :: run
      logical, intent(out) :: rests
      integer(c_int), intent(out) :: status
      class(jointed_model), pointer :: model
      logical :: braced
      rests = .false.
      model => run%get_model()
      call brace_joints(model%law, run%options%settle_damping, model%own_law, braced, status)
      if (status /= status_ok) return
      call rest_by_damping(run, rests, status)
      if (braced .and. status == status_ok .and. rests) then
         call free_mortar(model%law, model%own_law)
         call rest_by_damping(run, rests, status)
      end if
      call move_alloc(model%own_law, model%law)
   end subroutine rest_with_mortar

   !> Rest by kinetic damping: whenever the kinetic energy has passed a peak, all stops
   subroutine rest_by_damping(run, rests, status)
      class(simulation), intent(inout), target :: run
      logical, intent(out) :: rests
      integer(c_int), intent(out) :: status
      integer, parameter :: batch = 8
      class(jointed_model), pointer :: model
      real(wp) :: now, before, step
      integer :: n

      status = status_ok
      rests = .false.
      model => run%get_model()
      ! A tiny step of the run must not keep from rest what stands.
      step = model%step
      model%step = max(step, run%options%fraction * run%record%critical)
      before = 0.0_wp
      n = run%record%settling
      do while (n < run%options%settle_steps)
         call take_exactly(run, batch, status)
         if (status /= status_ok) return
         n = n + batch
         now = run%measure_agitation()
         if (.not. now <= huge(now)) then
            status = status_not_finite
            return
         end if
         if (now < before) then
            call run%stop_bodies()
            before = 0.0_wp
            rests = run%measure_unbalance() < run%options%settle_tolerance .and. n < run%options%settle_steps
            if (rests) exit
         else
            before = now
         end if
         call run%check_limits(run%options%settlement)
         if (run%record%reason /= stop_end) exit
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
      end do
      model%step = min(model%step, step)   ! the step may have been cut as contacts formed
      run%record%settling = n
   end subroutine rest_by_damping

   !> Rest on rigid contacts: steps without inertia, until gravity moves nothing any more; gaps close meanwhile
   subroutine rest_by_waiting(run, rests, status)
      class(simulation), intent(inout), target :: run
      logical, intent(out) :: rests
      integer(c_int), intent(out) :: status
      integer, parameter :: most = 20000
      integer, parameter :: most_open = 100         !! steps in a row without impulses that fit, with
      real(wp), parameter :: wedging = 2.0_wp       !! a coefficient of friction from which on blocks may wedge
      class(jointed_model), pointer :: model
      logical :: quasi_static
      real(wp) :: speed
      integer :: open, before

      rests = .false.
      open = 0
      status = status_ok
      model => run%get_model()
      quasi_static = model%quasi_static
      model%quasi_static = .true.
      do while (run%record%settling < min(most, run%options%settle_steps))
         before = model%rigid%open_steps
         call take_exactly(run, 1, status)
         if (status /= status_ok) return
         run%record%settling = run%record%settling + 1
         speed = run%measure_speed()
         if (.not. speed <= huge(speed)) then
            status = status_not_finite
            return
         end if
         rests = speed < run%options%settle_tolerance * model%kick * model%rigid%gravity
         if (rests) exit
         open = merge(open + 1, 0, model%rigid%open_steps > before)
         associate (problem => model%rigid%problem)
            if (open >= most_open .and. any(problem%friction(:problem%points) > wedging)) exit
         end associate
         call run%check_limits(run%options%settlement)
         if (run%record%reason /= stop_end) exit
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
      end do
      model%quasi_static = quasi_static
      call run%stop_bodies()
   end subroutine rest_by_waiting

   !> Exactly `count` steps, each search before the step that needs it: forces and energies are those of the contacts of the last step
   subroutine take_exactly(run, count, status)
      class(simulation), intent(inout), target :: run
      integer, intent(in) :: count
      integer(c_int), intent(out) :: status
      class(jointed_model), pointer :: model
      integer :: target_steps
      real(wp) :: stable, suitable

      status = status_ok
      model => run%get_model()
      target_steps = model%steps + count
      do while (model%steps < target_steps)
         if (model%stale) then
            model%stale = .false.
            call run%find_pairs(.false., status)
            if (status /= status_ok) return
            run%record%searches = run%record%searches + 1
            run%record%most_pairs = max(run%record%most_pairs, run%record%pairs)
            ! New contacts may be stiffer than those of the start.
            call run%find_stable_step(stable, suitable, status)
            if (status /= status_ok) return
            if (model%step > 0.9_wp * stable) model%step = 0.5_wp * stable
            run%record%least_step = min(run%record%least_step, model%step)
         end if
         call run%take_steps(target_steps - model%steps, status)
         if (status /= status_ok) return
      end do
   end subroutine take_exactly

   !> Shake a paused model to its end, or for about `steps` steps more; what was recorded up to a stop is valid.
   !> Where it pauses changes no bit of what follows.
   subroutine run_on(run, steps, status)
      class(simulation), intent(inout), target :: run
      integer, intent(in) :: steps                   !! 0: to the end
      integer(c_int), intent(out) :: status
      class(jointed_model), pointer :: model
      type(energy_terms) :: energy
      real(wp) :: quiet
      integer :: n, before
      logical :: due

      model => run%get_model()
      quiet = movement_end(model%load)
      before = model%steps
      associate (record => run%record, options => run%options)
         record%paused = .false.
         do
            due = .false.
            n = steps_between_checks
            if (record%points < size(record%wanted)) then
               n = max(1, nint((record%wanted(record%points + 1) - (model%t - model%drift)) / model%step))
               due = n <= steps_between_checks
               n = min(n, steps_between_checks)
            end if
            call take_exactly(run, n, status)
            if (status /= status_ok) exit
            energy = run%measure_energy()
            record%round = max(record%round, energy%kinetic + abs(energy%potential - record%start%potential) &
               + energy%friction + energy%damping + energy%mass_damping)
            record%residual = max(record%residual, energy_from_nowhere(run, energy))
            ! Time may have stood still meanwhile, or the step have been cut.
            if (due .and. model%quasi_static) due = model%t > record%wanted(record%points + 1)
            if (due .and. .not. model%quasi_static) due = model%t - model%drift &
               > record%wanted(record%points + 1) - 0.51_wp * model%step
            if (due) call record_point(run, energy)
            if (.not. record%residual <= options%residual_limit) then
               record%reason = stop_blow_up
               record%blamed(1) = run%find_fastest()
            end if
            if (record%reason == stop_end) call run%check_limits(options%collapse)
            if (options%stop_at_rest .and. model%t > quiet) then
               record%calm_looks = merge(record%calm_looks + 1, 0, run%measure_unbalance() < 1.0e-3_wp &
                  .and. (model%quasi_static .or. energy%kinetic < 1.0e-6_wp * record%round))
               if (record%calm_looks >= 50 .and. record%reason == stop_end) record%reason = stop_rest
               if (energy%kinetic < options%safe .and. abs(options%above + energy%potential + energy%elastic &
                  - record%start%potential - record%start%elastic) < options%safe .and. record%reason == stop_end) then
                 record%reason = stop_rest
               end if
            end if
            if (record%reason /= stop_end .or. model%t - model%drift >= options%end_time - 0.5_wp * model%step) exit
            record%paused = .true.
            if (cancel_requested()) status = status_cancelled
            if (status /= status_ok .or. (steps > 0 .and. model%steps - before >= steps)) exit
            record%paused = .false.
         end do
         record%stop_time = model%t - model%drift
      end associate
   end subroutine run_on

   !> Error of the energy balance over the total energy exchanged; energy that rigid contacts dissipate must not return,
   !> or it counts as an error, too. Without inertia there is no energy balance
   function energy_from_nowhere(run, energy) result(ratio)
      class(simulation), intent(inout), target :: run
      type(energy_terms), intent(in) :: energy       !! now
      real(wp) :: ratio
      !> Of the fall of all blocks by the size of the smallest: energy below which rigid contacts do not move
      real(wp), parameter :: still = 1.0e-6_wp
      class(jointed_model), pointer :: model
      real(wp) :: nowhere, round
      model => run%get_model()
      ratio = 0.0_wp
      if (model%quasi_static) return
      associate (record => run%record)
         nowhere = abs(energy_residual(energy, record%start))
         round = max(record%round, record%start%elastic, tiny(1.0_wp))
         if (model%rigid%setting%used) then
            ! In the midst of a rebound half of its impulse is booked, which takes more than the whole.
            record%taken = max(record%taken, min(record%damping, energy%damping))
            record%damping = energy%damping
            nowhere = nowhere + max(0.0_wp, record%taken - energy%damping)
            round = max(round, still * model%rigid%size * model%rigid%gravity * model%rigid%mass)
         end if
         ratio = nowhere / round
      end associate
   end function energy_from_nowhere

   !> State at the time of the last forces: half a step before the velocities, a step before the places
   subroutine record_point(run, energy)
      class(simulation), intent(inout), target :: run
      type(energy_terms), intent(in) :: energy
      class(jointed_model), pointer :: model
      model => run%get_model()
      associate (record => run%record)
         if (record%points >= size(record%wanted)) return
         record%points = record%points + 1
         record%time(record%points) = model%t - model%drift
         record%energy(:, record%points) = energy_row(energy, record%start)
         record%tension(:, record%points) = tie_forces(model%ties)
      end associate
      call run%record_state()
   end subroutine record_point

end module dem_run
