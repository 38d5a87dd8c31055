!> A run of rigid bodies from rest to its end: settle under gravity, shake, watch, record.
!>
!> How a run goes stands here once, for blocks of the plane (dem_plane_run) and of space (dem3_run). They tell what it
!> needs to know of their models: the hooks of `simulation`.
module dem_run
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : dem_energy_count, stop_end => dem_stop_end, stop_blow_up => dem_stop_blow_up, &
      stop_rest => dem_stop_rest, stop_restless => dem_stop_restless, stop_step => dem_stop_step, &
      stop_unsettled => dem_stop_unsettled
   use common_status, only : status_ok, status_cancelled, status_not_finite, status_out_of_memory
   use dem_clock, only : model_clock
   use dem_energy, only : energy_terms, energy_residual, energy_row
   use dem_loading, only : movement_end
   use dem_rigid, only : forget_effort, rigid_solver
   use dem_tape, only : tape
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: run_options, run_record, run_record_new, simulation, run_begin, run_on, any_step, model_sizes, &
      slides_not

   !> Greatest stable step where any step is stable [s]
   real(wp), parameter :: any_step = huge(1.0_wp)
   integer, parameter :: watch = 64          !! steps between two looks at limits
   integer, parameter :: model_sizes = 8     !! that a state tells of a model

   type :: run_options
      real(wp) :: end_time = 0.0_wp          !! [s]
      real(wp) :: step = 0.0_wp              !! [s]; 0: the fraction of the critical step
      real(wp) :: fraction = 0.3_wp          !! of the critical step
      real(wp) :: settle_tolerance = 1.0e-6_wp  !! unbalanced force over weight
      real(wp) :: settlement = 0.0_wp        !! displacement by which a body falls instead of settling [m]; 0: none
      real(wp) :: collapse = 0.0_wp          !! displacement that counts as collapse [m]; 0: none
      real(wp) :: residual_limit = 0.1_wp    !! of the energy that went round
      real(wp) :: settle_damping = 0.0_wp    !! beta of all joints while they settle, where their own is less [s]
      real(wp) :: collapse_turn = 0.0_wp     !! a body that moved that far has collapsed where it turned by more [rad]
      real(wp) :: collapse_drop = 0.0_wp     !! or is lower by more [m]; both 0: the displacement alone counts
      integer :: settle_steps = 0            !! at most; 0: no settling
      logical :: stop_at_rest = .false.      !! once the ground is quiet
      integer :: threads = 1
   end type run_options

   !> What a run leaves. The reason is one of the list dem_stop
   type :: run_record
      real(wp), allocatable :: wanted(:)        !! (nt) output times [s]
      real(wp), allocatable :: time(:)          !! (nt) times of the nearest steps [s]
      real(wp), allocatable :: place(:, :, :)   !! (3, bodies, nt) plane: x, y [m], rotation [rad]; space: centroids [m]
      real(wp), allocatable :: turn(:, :, :, :) !! (3, 3, bodies, nt) columns: the bodies' own axes; plane: of no body
      real(wp), allocatable :: rate(:, :, :)    !! (3 or 6, bodies, nt) velocity, spin; relative to the ground
      real(wp), allocatable :: energy(:, :)     !! (dem_energy_count, nt) [J]
      integer :: points = 0
      integer(c_int) :: reason = stop_end
      integer :: blamed(2) = 0               !! bodies that caused the stop, 0 none
      integer :: settling = 0                !! steps it took
      integer :: searches = 0
      integer :: pairs = 0                   !! that are near
      integer :: most_pairs = 0              !! after a search on the way
      real(wp) :: least_step = 0.0_wp        !! [s]
      real(wp) :: critical = 0.0_wp          !! critical step at the start; 0 where any step is stable [s]
      real(wp) :: stop_time = 0.0_wp         !! [s]
      real(wp) :: residual = 0.0_wp          !! greatest, over the energy that went round
      type(energy_terms) :: start            !! energies as the shaking began
      real(wp) :: round = 0.0_wp             !! greatest energy that went round so far [J]
      real(wp) :: taken = 0.0_wp             !! greatest lasting loss by rigid contacts so far [J]
      real(wp) :: damping = 0.0_wp           !! loss at the look before [J]
      integer :: calm_looks = 0              !! looks in a row at which all was quiet
      logical :: begun = .false.
      logical :: paused = .false.            !! it has not come to its end and can go on
   end type run_record

   !> A model on its way. Bodies are counted from 1
   type, abstract :: simulation
      type(run_options) :: options
      type(run_record) :: record
   contains
      procedure(clock_of), deferred :: clock            !! of the model
      procedure(solver_of), deferred :: solver          !! of its rigid contacts; not used where there are springs
      procedure(find_pairs), deferred :: search         !! who is near whom
      procedure(find_steps), deferred :: stable_step    !! and the one to take where the options name none
      procedure(take_steps), deferred :: advance        !! up to so many steps, fewer where pairs must be searched again
      procedure(tell_energy), deferred :: energy        !! at the time of the last forces
      procedure(tell_number), deferred :: agitation     !! what moves while it settles, like a kinetic energy [J]
      procedure(tell_number), deferred :: speed         !! greatest of any body [m/s]
      procedure(tell_number), deferred :: unbalanced    !! greatest unbalanced force over weight, or moment
      procedure(tell_body), deferred :: least_balanced  !! the mobile body farthest from balance
      procedure(tell_body), deferred :: fastest         !! the mobile body of the greatest velocity
      procedure(look), deferred :: limits               !! has a body collapsed or left the scene?
      procedure(change), deferred :: mark_rest          !! places are counted from here
      procedure(change), deferred :: stop_all           !! no body moves
      procedure(hold_mortar), deferred :: brace_joints  !! damped to settle; mortar, where there is any, is unbreakable
      procedure(change), deferred :: free_mortar        !! it has its own strength again
      procedure(change), deferred :: free_joints        !! they have their own damping and strength again
      procedure(change), deferred :: forget_settling    !! no dashpot force, loss or count is left from it
      procedure(change), deferred :: put_down           !! places and rates at the last forces, as the last point
      procedure(lengths), deferred :: sizes             !! what a state has in common with the model; its lengths
      procedure(allocate_like), deferred :: make_room   !! for a state of such lengths
      procedure(walk_through), deferred :: walk         !! everything of the model that changes, always in this order
   end type simulation

   abstract interface
      function clock_of(run) result(clock)
         import :: simulation, model_clock
         implicit none
         class(simulation), intent(inout), target :: run
         type(model_clock), pointer :: clock
      end function clock_of

      function solver_of(run) result(solver)
         import :: simulation, rigid_solver
         implicit none
         class(simulation), intent(inout), target :: run
         class(rigid_solver), pointer :: solver
      end function solver_of

      subroutine find_pairs(run, first_time, status)
         import :: simulation, c_int
         implicit none
         class(simulation), intent(inout) :: run        !! its record tells how many
         logical, intent(in) :: first_time              !! then it refuses what was drawn wrong, by the record's reason
         integer(c_int), intent(out) :: status          !! not_finite where a place is no number
      end subroutine find_pairs

      subroutine find_steps(run, stable, suitable, status)
         import :: simulation, wp, c_int
         implicit none
         class(simulation), intent(inout) :: run
         real(wp), intent(out) :: stable                !! greatest stable step, or any_step [s]
         real(wp), intent(out) :: suitable              !! [s]
         integer(c_int), intent(out) :: status
      end subroutine find_steps

      subroutine take_steps(run, count, status)
         import :: simulation, c_int
         implicit none
         class(simulation), intent(inout) :: run
         integer, intent(in) :: count
         integer(c_int), intent(out) :: status
      end subroutine take_steps

      function tell_energy(run) result(now)
         import :: simulation, energy_terms
         implicit none
         class(simulation), intent(in) :: run
         type(energy_terms) :: now
      end function tell_energy

      function tell_number(run) result(number)
         import :: simulation, wp
         implicit none
         class(simulation), intent(in) :: run
         real(wp) :: number
      end function tell_number

      function tell_body(run) result(body)
         import :: simulation
         implicit none
         class(simulation), intent(in) :: run
         integer :: body
      end function tell_body

      subroutine look(run, collapse)
         import :: simulation, wp
         implicit none
         class(simulation), intent(inout) :: run        !! its record tells why it stops, and who is to blame
         real(wp), intent(in) :: collapse               !! displacement [m]; 0: none
      end subroutine look

      subroutine change(run)
         import :: simulation
         implicit none
         class(simulation), intent(inout) :: run
      end subroutine change

      subroutine hold_mortar(run, braced, status)
         import :: simulation, c_int
         implicit none
         class(simulation), intent(inout) :: run
         logical, intent(out) :: braced                 !! whether there is any
         integer(c_int), intent(out) :: status          !! status_out_of_memory, else ok
      end subroutine hold_mortar

      function lengths(run) result(sizes)
         import :: simulation, model_sizes, c_int64_t
         implicit none
         class(simulation), intent(in) :: run
         integer(c_int64_t) :: sizes(model_sizes)
      end function lengths

      subroutine allocate_like(run, sizes, most, status)
         import :: simulation, model_sizes, c_int, c_int64_t
         implicit none
         class(simulation), intent(inout) :: run
         integer(c_int64_t), intent(in) :: sizes(model_sizes)
         integer(c_int64_t), intent(in) :: most         !! that a length can be
         integer(c_int), intent(out) :: status
      end subroutine allocate_like

      subroutine walk_through(run, on, status)
         import :: simulation, tape, c_int
         implicit none
         class(simulation), intent(inout), target :: run
         type(tape), intent(inout) :: on
         integer(c_int), intent(out) :: status
      end subroutine walk_through
   end interface

contains

   !> A record for `bodies` bodies at the times `wanted`
   subroutine run_record_new(bodies, rates, attitudes, wanted, record, status)
      integer, intent(in) :: bodies
      integer, intent(in) :: rates                   !! of a body
      logical, intent(in) :: attitudes               !! they are no part of its place
      real(wp), intent(in) :: wanted(:)              !! [s]
      type(run_record), intent(out) :: record
      integer(c_int), intent(out) :: status
      integer :: nt, failed
      nt = size(wanted)
      allocate (record%wanted(nt), record%time(nt), record%place(3, bodies, nt), record%rate(rates, bodies, nt), &
         record%turn(3, 3, merge(bodies, 0, attitudes), nt), record%energy(dem_energy_count, nt), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed == 0) record%wanted(:) = wanted
   end subroutine run_record_new

   !> Whether a body that moved farther than counts as collapse did more than slide: it turned or is lower
   pure function slides_not(options, turned, dropped) result(gone)
      type(run_options), intent(in) :: options
      real(wp), intent(in) :: turned                 !! [rad]
      real(wp), intent(in) :: dropped                !! [m]
      logical :: gone
      gone = max(options%collapse_turn, options%collapse_drop) <= 0.0_wp
      if (.not. gone) gone = turned > options%collapse_turn .or. dropped > options%collapse_drop
   end function slides_not

   !> Settle a model and take the first step of its motion; paused then, unless it cannot run
   subroutine run_begin(run, status)
      class(simulation), intent(inout), target :: run
      integer(c_int), intent(out) :: status
      type(model_clock), pointer :: clock
      type(energy_terms) :: start
      real(wp) :: stable, suitable

      run%record%begun = .true.
      clock => run%clock()
      call run%search(.true., status)
      if (status /= status_ok) return
      call run%stable_step(stable, suitable, status)
      if (status /= status_ok) return
      if (stable < any_step) run%record%critical = stable
      clock%step = run%options%step
      if (.not. clock%step > 0.0_wp) clock%step = suitable
      run%record%least_step = clock%step
      if (clock%step > stable) run%record%reason = stop_step
      if (run%record%reason /= stop_end) return
      call run%mark_rest()
      if (run%options%settle_steps > 0) then
         call settle(run, status)
         if (status /= status_ok .or. run%record%reason /= stop_end) return
      end if
      call run%mark_rest()
      clock%shaking = .true.
      call several(run, 1, status)
      if (status /= status_ok) return
      start = run%energy()
      run%record%start = start
      call write_down(run, start)
      run%record%paused = .true.
   end subroutine run_begin

   !> Rest under gravity; time begins then
   subroutine settle(run, status)
      class(simulation), intent(inout), target :: run
      integer(c_int), intent(out) :: status
      type(model_clock), pointer :: clock
      class(rigid_solver), pointer :: solver
      logical :: rests
      clock => run%clock()
      solver => run%solver()
      clock%shaking = .false.
      if (solver%setting%used) then
         call rest_by_waiting(run, rests, status)
      else
         call rest_with_mortar(run, rests, status)
      end if
      if (status /= status_ok) return
      if (.not. rests) then
         run%record%reason = merge(stop_restless, stop_unsettled, run%record%reason == stop_end)
         if (run%record%blamed(1) == 0) run%record%blamed(1) = run%least_balanced()
      end if
      call run%forget_settling()
      if (rests) call forget_effort(solver)
      clock%t = 0.0_wp
      clock%drift = 0.0_wp
      clock%steps = 0
   end subroutine settle

   !> Rest on springs, damped as much as rest needs, whatever the damping of the motion. Mortar does not break while the
   !> weight comes, which comes at once and overshoots; then what cannot bear the weight at rest breaks, and all comes
   !> to rest anew.
   subroutine rest_with_mortar(run, rests, status)
      class(simulation), intent(inout), target :: run
      logical, intent(out) :: rests
      integer(c_int), intent(out) :: status
      logical :: braced
      rests = .false.
      call run%brace_joints(braced, status)
      if (status /= status_ok) return
      call rest_by_damping(run, rests, status)
      if (braced .and. status == status_ok .and. rests) then
         call run%free_mortar()
         call rest_by_damping(run, rests, status)
      end if
      call run%free_joints()
   end subroutine rest_with_mortar

   !> Rest by kinetic damping: whenever the kinetic energy has passed a peak, all stops
   subroutine rest_by_damping(run, rests, status)
      class(simulation), intent(inout), target :: run
      logical, intent(out) :: rests
      integer(c_int), intent(out) :: status
      integer, parameter :: batch = 8
      type(model_clock), pointer :: clock
      real(wp) :: now, before, step
      integer :: n

      status = status_ok
      rests = .false.
      clock => run%clock()
      ! A tiny step of the run must not keep from rest what stands.
      step = clock%step
      clock%step = max(step, run%options%fraction * run%record%critical)
      before = 0.0_wp
      n = run%record%settling
      do while (n < run%options%settle_steps)
         call several(run, batch, status)
         if (status /= status_ok) return
         n = n + batch
         now = run%agitation()
         if (.not. now <= huge(now)) then
            status = status_not_finite
            return
         end if
         if (now < before) then
            call run%stop_all()
            before = 0.0_wp
            rests = run%unbalanced() < run%options%settle_tolerance .and. n < run%options%settle_steps
            if (rests) exit
         else
            before = now
         end if
         call run%limits(run%options%settlement)
         if (run%record%reason /= stop_end) exit
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
      end do
      clock%step = min(clock%step, step)   ! the step may have been cut as contacts formed
      run%record%settling = n
   end subroutine rest_by_damping

   !> Rest on rigid contacts: steps without inertia, until gravity moves nothing any more; gaps close meanwhile
   subroutine rest_by_waiting(run, rests, status)
      class(simulation), intent(inout), target :: run
      logical, intent(out) :: rests
      integer(c_int), intent(out) :: status
      integer, parameter :: most = 20000
      integer, parameter :: most_open = 100         !! steps in a row without impulses that fit
      type(model_clock), pointer :: clock
      class(rigid_solver), pointer :: solver
      logical :: quasi_static
      real(wp) :: speed
      integer :: open, before

      rests = .false.
      open = 0
      status = status_ok
      clock => run%clock()
      solver => run%solver()
      quasi_static = clock%quasi_static
      clock%quasi_static = .true.
      do while (run%record%settling < min(most, run%options%settle_steps))
         before = solver%open_steps
         call several(run, 1, status)
         if (status /= status_ok) return
         run%record%settling = run%record%settling + 1
         speed = run%speed()
         if (.not. speed <= huge(speed)) then
            status = status_not_finite
            return
         end if
         rests = speed < run%options%settle_tolerance * clock%kick * solver%gravity
         if (rests) exit
         open = merge(open + 1, 0, solver%open_steps > before)
         if (open == most_open) exit
         call run%limits(run%options%settlement)
         if (run%record%reason /= stop_end) exit
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
      end do
      clock%quasi_static = quasi_static
      call run%stop_all()
   end subroutine rest_by_waiting

   !> Exactly `count` steps, with searches in between
   subroutine several(run, count, status)
      class(simulation), intent(inout), target :: run
      integer, intent(in) :: count
      integer(c_int), intent(out) :: status
      type(model_clock), pointer :: clock
      integer :: target_steps
      real(wp) :: stable, suitable

      status = status_ok
      clock => run%clock()
      target_steps = clock%steps + count
      do while (clock%steps < target_steps)
         call run%advance(target_steps - clock%steps, status)
         if (status /= status_ok) return
         if (.not. clock%stale) cycle
         clock%stale = .false.
         call run%search(.false., status)
         if (status /= status_ok) return
         run%record%searches = run%record%searches + 1
         run%record%most_pairs = max(run%record%most_pairs, run%record%pairs)
         ! New contacts may be stiffer than those of the start.
         call run%stable_step(stable, suitable, status)
         if (status /= status_ok) return
         if (clock%step > 0.9_wp * stable) clock%step = 0.5_wp * stable
         run%record%least_step = min(run%record%least_step, clock%step)
      end do
   end subroutine several

   !> Shake a paused model to its end, or for about `steps` steps more; what was recorded up to a stop is valid.
   !> Where it pauses changes no bit of what follows.
   subroutine run_on(run, steps, status)
      class(simulation), intent(inout), target :: run
      integer, intent(in) :: steps                   !! 0: to the end
      integer(c_int), intent(out) :: status
      type(model_clock), pointer :: clock
      type(energy_terms) :: energy
      real(wp) :: quiet
      integer :: n, before
      logical :: due

      clock => run%clock()
      quiet = movement_end(clock%load)
      before = clock%steps
      associate (record => run%record, options => run%options)
         record%paused = .false.
         do
            due = .false.
            n = watch
            if (record%points < size(record%wanted)) then
               n = max(1, nint((record%wanted(record%points + 1) - (clock%t - clock%drift)) / clock%step))
               due = n <= watch
               n = min(n, watch)
            end if
            call several(run, n, status)
            if (status /= status_ok) exit
            energy = run%energy()
            record%round = max(record%round, energy%kinetic + abs(energy%potential - record%start%potential) &
               + energy%friction + energy%damping + energy%mass_damping)
            record%residual = max(record%residual, energy_from_nowhere(run, energy))
            ! Time may have stood still meanwhile.
            if (due .and. clock%quasi_static) due = clock%t > record%wanted(record%points + 1)
            if (due) call write_down(run, energy)
            if (.not. record%residual <= options%residual_limit) then
               record%reason = stop_blow_up
               record%blamed(1) = run%fastest()
            end if
            if (record%reason == stop_end) call run%limits(options%collapse)
            if (options%stop_at_rest .and. clock%t > quiet) then
               record%calm_looks = merge(record%calm_looks + 1, 0, run%unbalanced() < 1.0e-3_wp &
                  .and. (clock%quasi_static .or. energy%kinetic < 1.0e-6_wp * record%round))
               if (record%calm_looks >= 50 .and. record%reason == stop_end) record%reason = stop_rest
            end if
            if (record%reason /= stop_end .or. clock%t - clock%drift >= options%end_time - 0.5_wp * clock%step) exit
            record%paused = .true.
            if (cancel_requested()) status = status_cancelled
            if (status /= status_ok .or. (steps > 0 .and. clock%steps - before >= steps)) exit
            record%paused = .false.
         end do
         record%stop_time = clock%t - clock%drift
      end associate
   end subroutine run_on

   !> Energy that came from nowhere, over the energy that went round; what rigid contacts take they must not give back,
   !> or it came from nowhere too. Without inertia there is no ledger
   function energy_from_nowhere(run, energy) result(ratio)
      class(simulation), intent(inout), target :: run
      type(energy_terms), intent(in) :: energy       !! now
      real(wp) :: ratio
      !> Of the fall of all blocks by the size of the smallest: energy below which rigid contacts do not move
      real(wp), parameter :: still = 1.0e-6_wp
      type(model_clock), pointer :: clock
      class(rigid_solver), pointer :: solver
      real(wp) :: nowhere, round
      clock => run%clock()
      solver => run%solver()
      ratio = 0.0_wp
      if (clock%quasi_static) return
      associate (record => run%record)
         nowhere = abs(energy_residual(energy, record%start))
         round = max(record%round, record%start%elastic, tiny(1.0_wp))
         if (solver%setting%used) then
            ! In the midst of a rebound half of its impulse is booked, which takes more than the whole.
            record%taken = max(record%taken, min(record%damping, energy%damping))
            record%damping = energy%damping
            nowhere = nowhere + max(0.0_wp, record%taken - energy%damping)
            round = max(round, still * solver%size * solver%gravity * solver%mass)
         end if
         ratio = nowhere / round
      end associate
   end function energy_from_nowhere

   !> State at the time of the last forces: half a step before the velocities, a step before the places
   subroutine write_down(run, energy)
      class(simulation), intent(inout), target :: run
      type(energy_terms), intent(in) :: energy
      type(model_clock), pointer :: clock
      clock => run%clock()
      associate (record => run%record)
         if (record%points >= size(record%wanted)) return
         record%points = record%points + 1
         record%time(record%points) = clock%t - clock%drift
         record%energy(:, record%points) = energy_row(energy, record%start)
      end associate
      call run%put_down()
   end subroutine write_down

end module dem_run
