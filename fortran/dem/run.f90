!> A run from rest to its end: settle under gravity, shake, watch, record.
module dem_run
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : dem_energy_count, dem_energy_kinetic, dem_energy_potential, dem_energy_elastic, &
      dem_energy_friction, dem_energy_damping, dem_energy_mass_damping, dem_energy_work, dem_energy_residual, &
      dem_energy_leapfrog, stop_end => dem_stop_end, stop_collapse => dem_stop_collapse, stop_rest => dem_stop_rest, &
      stop_left => dem_stop_left, stop_blow_up => dem_stop_blow_up, stop_step => dem_stop_step, &
      stop_unsettled => dem_stop_unsettled, stop_overlap => dem_stop_overlap
   use common_status, only : status_ok, status_cancelled, status_not_finite, status_out_of_memory
   use dem_contacts, only : contact_pair, overlap, measure
   use dem_energy, only : energy_now, energy_residual, energy_terms
   use dem_loading, only : movement_end
   use dem_model, only : block_model, advance, critical_step
   use dem_moreau, only : advance_rigid, rigid_step
   use dem_search, only : search
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: run_options, run_record, run_record_new, run_begin, run_on

   type :: run_options
      real(wp) :: end_time = 0.0_wp          !! [s]
      real(wp) :: step = 0.0_wp              !! [s]; 0: the fraction of the critical step
      real(wp) :: fraction = 0.3_wp          !! of the critical step
      real(wp) :: settle_tolerance = 1.0e-6_wp  !! unbalanced force over weight
      integer :: settle_steps = 0            !! at most; 0: no settling
      real(wp) :: collapse = 0.0_wp          !! displacement that counts as collapse [m]; 0: none
      real(wp) :: domain(4) = 0.0_wp         !! left, right, bottom, top [m]
      real(wp) :: residual_limit = 0.1_wp    !! of the energy that went round
      logical :: stop_at_rest = .false.      !! once the ground is quiet
      integer :: threads = 1
      real(wp) :: settlement = 0.0_wp        !! displacement by which a body falls instead of settling [m]; 0: none
   end type run_options

   !> What a run leaves. The reason is one of the list dem_stop
   type :: run_record
      real(wp), allocatable :: wanted(:)        !! (nt) output times [s]
      real(wp), allocatable :: time(:)          !! (nt) times of the nearest steps [s]
      real(wp), allocatable :: place(:, :, :)   !! (3, bodies, nt): x, y [m], rotation [rad]
      real(wp), allocatable :: rate(:, :, :)    !! (3, bodies, nt), relative to the ground
      real(wp), allocatable :: energy(:, :)     !! (dem_energy_count, nt) [J]
      integer :: points = 0
      integer(c_int) :: reason = stop_end
      integer :: blamed(2) = 0               !! bodies that caused the stop, 0 none
      integer :: settling = 0                !! steps it took
      integer :: searches = 0
      integer :: most_pairs = 0
      real(wp) :: least_step = 0.0_wp        !! [s]
      real(wp) :: critical = 0.0_wp          !! critical step at the start [s]
      real(wp) :: stop_time = 0.0_wp         !! [s]
      real(wp) :: residual = 0.0_wp          !! greatest, over the energy that went round
      type(energy_terms) :: start            !! energies as the shaking began
      real(wp) :: round = 0.0_wp             !! greatest energy that went round so far [J]
      real(wp) :: taken = 0.0_wp             !! greatest loss by rigid contacts so far [J]
      integer :: calm_looks = 0              !! looks in a row at which all was quiet
      logical :: paused = .false.            !! it has not come to its end and can go on
   end type run_record

   integer, parameter :: watch = 64          !! steps between two looks at limits

contains

   !> A record for `bodies` bodies at the times `wanted`
   subroutine run_record_new(bodies, wanted, record, status)
      integer, intent(in) :: bodies
      real(wp), intent(in) :: wanted(:)              !! [s]
      type(run_record), intent(out) :: record
      integer(c_int), intent(out) :: status
      integer :: failed
      allocate (record%wanted(size(wanted)), record%time(size(wanted)), record%place(3, bodies, size(wanted)), &
         record%rate(3, bodies, size(wanted)), record%energy(dem_energy_count, size(wanted)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed == 0) record%wanted(:) = wanted
   end subroutine run_record_new

   !> Settle a model and take the first step of its motion; paused then, unless it cannot run
   subroutine run_begin(model, options, record, status)
      type(block_model), intent(inout) :: model
      type(run_options), intent(in) :: options
      type(run_record), intent(inout) :: record
      integer(c_int), intent(out) :: status

      model%contacts%skin = 0.02_wp * model%set%size
      call search(model%set, model%contacts, .true., status)
      if (status /= status_ok) return
      call critical_step(model, record%critical, status)
      if (status /= status_ok) return
      model%step = options%step
      if (model%rigid%used) record%critical = 0.0_wp     ! none: any step is stable
      if (.not. model%step > 0.0_wp) model%step = options%fraction * record%critical
      if (.not. model%step > 0.0_wp) model%step = rigid_step(model)
      record%least_step = model%step
      if (model%step > record%critical .and. .not. model%rigid%used) record%reason = stop_step
      if (record%reason == stop_end) call overlapping(model, record)
      if (record%reason /= stop_end) return
      call mark_rest(model)
      if (options%settle_steps > 0) then
         call settle(model, options, record, status)
         if (status /= status_ok .or. record%reason /= stop_end) return
      end if
      call mark_rest(model)
      model%shaking = .true.
      call several(model, 1, options%threads, record, status)
      if (status /= status_ok) return
      record%start = energy_now(model)
      call write_down(model, record, record%start)
      record%paused = .true.
   end subroutine run_begin

   !> Bodies that overlap deeper than half the skin were drawn so
   subroutine overlapping(model, record)
      type(block_model), intent(in) :: model
      type(run_record), intent(inout) :: record
      integer :: k
      type(overlap) :: now
      do k = 1, model%contacts%pairs
         associate (pair => model%contacts%pair(k))
            call measure(pair, model%set%item(pair%bodies(1)), model%set%item(pair%bodies(2)), now)
            if (now%width <= 0.5_wp * model%contacts%skin .or. maxval(now%gap) > -0.5_wp * model%contacts%skin) cycle
            record%reason = stop_overlap
            record%blamed = pair%bodies
            return
         end associate
      end do
   end subroutine overlapping

   subroutine mark_rest(model)
      type(block_model), intent(inout) :: model
      model%set%item%rest_x = model%set%item%x
      model%set%item%rest_y = model%set%item%y
      model%set%item%rest_angle = model%set%item%angle
   end subroutine mark_rest

   !> Rest under gravity: by kinetic damping on springs, or without inertia where contacts are rigid
   subroutine settle(model, options, record, status)
      type(block_model), intent(inout) :: model
      type(run_options), intent(in) :: options
      type(run_record), intent(inout) :: record
      integer(c_int), intent(out) :: status
      type(run_options) :: quiet
      logical :: rests

      ! A tiny step or collapse limit of the run must not keep from rest what stands.
      quiet = options
      quiet%collapse = options%settlement
      model%shaking = .false.
      if (model%rigid%used) then
         call settle_rigid(model, quiet, record, rests, status)
      else
         call settle_springs(model, quiet, record, rests, status)
      end if
      if (status /= status_ok) return
      if (.not. rests) then
         record%reason = stop_unsettled
         if (record%blamed(1) == 0) record%blamed(1) = maxloc(abs(model%set%item%fx * model%set%item%inverse_mass) &
            + abs(model%set%item%fy * model%set%item%inverse_mass + model%load%gravity(2)), &
            mask=.not. model%set%item%fixed, dim=1)
      end if
      call calm(model)
      model%set%item%bounces = 0
      model%set%item%airborne = 0.0_wp
      model%t = 0.0_wp
      model%drift = 0.0_wp
      model%steps = 0
   end subroutine settle

   !> Whenever the kinetic energy has passed a peak, all stops
   subroutine settle_springs(model, options, record, rests, status)
      type(block_model), intent(inout) :: model
      type(run_options), intent(in) :: options
      type(run_record), intent(inout) :: record
      logical, intent(out) :: rests
      integer(c_int), intent(out) :: status
      integer, parameter :: batch = 8
      real(wp) :: kinetic, before, step
      integer :: n

      status = status_ok
      rests = .false.
      step = model%step
      model%step = max(step, options%fraction * record%critical)
      before = 0.0_wp
      n = 0
      do while (n < options%settle_steps)
         call several(model, batch, options%threads, record, status)
         if (status /= status_ok) return
         n = n + batch
         kinetic = sum(model%set%item%mass * (model%set%item%vx**2 + model%set%item%vy**2) &
                       + model%set%item%inertia * model%set%item%spin**2)
         if (.not. kinetic <= huge(kinetic)) then
            status = status_not_finite
            return
         end if
         if (kinetic < before) then
            call stop_all(model)
            before = 0.0_wp
            rests = unbalanced(model) < options%settle_tolerance .and. n < options%settle_steps
            if (rests) exit
         else
            before = kinetic
         end if
         call limits(model, options, record)
         if (record%reason /= stop_end) exit
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
      end do
      model%step = min(model%step, step)   ! the step may have been cut as contacts formed
      record%settling = n
   end subroutine settle_springs

   !> Steps without inertia, until gravity moves nothing any more; gaps close meanwhile
   subroutine settle_rigid(model, options, record, rests, status)
      type(block_model), intent(inout) :: model
      type(run_options), intent(in) :: options
      type(run_record), intent(inout) :: record
      logical, intent(out) :: rests
      integer(c_int), intent(out) :: status
      integer, parameter :: most = 20000
      logical :: quasi_static
      real(wp) :: speed

      rests = .false.
      quasi_static = model%rigid%quasi_static
      model%rigid%quasi_static = .true.
      do while (record%settling < min(most, options%settle_steps))
         call several(model, 1, options%threads, record, status)
         if (status /= status_ok) return
         record%settling = record%settling + 1
         associate (b => model%set%item)
            speed = maxval(abs(b%vx) + abs(b%vy) + b%radius * abs(b%spin))
         end associate
         if (.not. speed <= huge(speed)) then
            status = status_not_finite
            return
         end if
         rests = speed < options%settle_tolerance * model%kick * hypot(model%load%gravity(1), model%load%gravity(2))
         if (rests) exit
         call limits(model, options, record)
         if (record%reason /= stop_end) exit
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
      end do
      model%rigid%quasi_static = quasi_static
      call stop_all(model)
      model%rigid%steps = 0
      model%rigid%factors = 0
      model%rigid%most_rounds = 0
      model%rigid%open_steps = 0
      model%rigid%residual = 0.0_wp
   end subroutine settle_rigid

   subroutine stop_all(model)
      type(block_model), intent(inout) :: model
      model%set%item%vx = 0.0_wp
      model%set%item%vy = 0.0_wp
      model%set%item%spin = 0.0_wp
   end subroutine stop_all

   !> No dashpot force and no loss is left from settling
   subroutine calm(model)
      type(block_model), intent(inout) :: model
      integer :: k, i
      do k = 1, model%contacts%pairs
         do i = 1, 2
            associate (point => model%contacts%pair(k)%point(i))
               point%dash_n = 0.0_wp
               point%dash_s = 0.0_wp
               point%friction_loss = 0.0_wp
               point%damping_loss = 0.0_wp
            end associate
         end do
         model%contacts%pair(k)%loss_before = 0.0_wp
         model%contacts%pair(k)%support_work = 0.0_wp
      end do
      model%contacts%friction_loss = 0.0_wp
      model%contacts%damping_loss = 0.0_wp
      model%contacts%support_work = 0.0_wp
      model%set%item%work = 0.0_wp
      model%set%item%mass_loss = 0.0_wp
   end subroutine calm

   !> Greatest unbalanced force over weight, and moment over weight times radius
   pure function unbalanced(model) result(ratio)
      type(block_model), intent(in) :: model
      real(wp) :: ratio
      real(wp) :: g
      integer :: k
      g = max(hypot(model%load%gravity(1), model%load%gravity(2)), 1.0e-3_wp)
      ratio = 0.0_wp
      do k = 1, size(model%set%item)
         associate (b => model%set%item(k))
            if (b%fixed) cycle
            ratio = max(ratio, abs(b%fx / b%mass + model%load%gravity(1)) / g, &
               abs(b%fy / b%mass + model%load%gravity(2)) / g, abs(b%moment) / (b%mass * g * b%radius))
         end associate
      end do
   end function unbalanced

   !> Exactly `count` steps, with searches in between
   subroutine several(model, count, threads, record, status)
      type(block_model), intent(inout) :: model
      integer, intent(in) :: count
      integer, intent(in) :: threads
      type(run_record), intent(inout) :: record
      integer(c_int), intent(out) :: status
      integer :: target_steps
      real(wp) :: critical

      status = status_ok
      target_steps = model%steps + count
      do while (model%steps < target_steps)
         if (model%rigid%used) then
            call advance_rigid(model, target_steps - model%steps, status)
            if (status /= status_ok) return
         else
            call advance(model, target_steps - model%steps, threads)
         end if
         if (.not. model%stale) cycle
         model%stale = .false.
         if (.not. all(abs(model%set%item%x) + abs(model%set%item%y) <= huge(1.0_wp))) then
            status = status_not_finite
            return
         end if
         call search(model%set, model%contacts, .false., status)
         if (status /= status_ok) return
         record%searches = record%searches + 1
         record%most_pairs = max(record%most_pairs, model%contacts%pairs)
         if (model%rigid%used) cycle
         ! New contacts may be stiffer than those of the start.
         call critical_step(model, critical, status)
         if (status /= status_ok) return
         if (model%step > 0.9_wp * critical) model%step = 0.5_wp * critical
         record%least_step = min(record%least_step, model%step)
      end do
   end subroutine several

   !> Shake a paused model to its end, or for about `steps` steps more; what was recorded up to a stop is valid.
   !> Where it pauses changes no bit of what follows.
   subroutine run_on(model, options, steps, record, status)
      type(block_model), intent(inout) :: model
      type(run_options), intent(in) :: options
      integer, intent(in) :: steps                   !! 0: to the end
      type(run_record), intent(inout) :: record
      integer(c_int), intent(out) :: status
      type(energy_terms) :: energy
      real(wp) :: quiet
      integer :: n, before
      logical :: due

      quiet = movement_end(model%load)
      before = model%steps
      record%paused = .false.
      do
         due = .false.
         n = watch
         if (record%points < size(record%wanted)) then
            n = max(1, nint((record%wanted(record%points + 1) - (model%t - model%drift)) / model%step))
            due = n <= watch
            n = min(n, watch)
         end if
         call several(model, n, options%threads, record, status)
         if (status /= status_ok) exit
         energy = energy_now(model)
         record%round = max(record%round, energy%kinetic + abs(energy%potential - record%start%potential) &
            + energy%friction + energy%damping + energy%mass_damping)
         if (.not. model%rigid%quasi_static) record%residual = max(record%residual, &
            energy_missing(model, record, energy) / max(record%round, record%start%elastic, still(model), tiny(1.0_wp)))
         ! Time may have stood still meanwhile.
         if (due .and. model%rigid%quasi_static) due = model%t > record%wanted(record%points + 1)
         if (due) call write_down(model, record, energy)
         if (.not. record%residual <= options%residual_limit) then
            record%reason = stop_blow_up
            record%blamed(1) = maxloc(model%set%item%vx**2 + model%set%item%vy**2, &
               mask=.not. model%set%item%fixed, dim=1)
         end if
         if (record%reason == stop_end) call limits(model, options, record)
         if (options%stop_at_rest .and. model%t > quiet) then
            record%calm_looks = merge(record%calm_looks + 1, 0, unbalanced(model) < 1.0e-3_wp &
               .and. (model%rigid%quasi_static .or. energy%kinetic < 1.0e-6_wp * record%round))
            if (record%calm_looks >= 50 .and. record%reason == stop_end) record%reason = stop_rest
         end if
         if (record%reason /= stop_end .or. model%t - model%drift >= options%end_time - 0.5_wp * model%step) exit
         record%paused = .true.
         if (cancel_requested()) status = status_cancelled
         if (status /= status_ok .or. (steps > 0 .and. model%steps - before >= steps)) exit
         record%paused = .false.
      end do
      record%stop_time = model%t - model%drift
   end subroutine run_on

   !> Energy below which rigid contacts do not move: a fall by a millionth of the smallest block [J]
   pure function still(model) result(energy)
      type(block_model), intent(in) :: model
      real(wp) :: energy
      energy = 0.0_wp
      if (model%rigid%used) energy = 1.0e-6_wp * model%set%size * hypot(model%load%gravity(1), model%load%gravity(2)) &
         * sum(model%set%item%mass)
   end function still

   !> Energy that came from nowhere; what rigid contacts take they must not give back, or it came from nowhere too [J]
   function energy_missing(model, record, energy) result(missing)
      type(block_model), intent(in) :: model
      type(run_record), intent(inout) :: record
      type(energy_terms), intent(in) :: energy
      real(wp) :: missing
      missing = abs(energy_residual(energy, record%start))
      if (.not. model%rigid%used) return
      record%taken = max(record%taken, energy%damping)
      missing = missing + record%taken - energy%damping
   end function energy_missing

   !> State at the time of the last forces: half a step before the velocities, a step before the places
   subroutine write_down(model, record, now)
      type(block_model), intent(in) :: model
      type(run_record), intent(inout) :: record
      type(energy_terms), intent(in) :: now
      integer :: k
      real(wp) :: half
      if (record%points >= size(record%wanted)) return
      record%points = record%points + 1
      record%time(record%points) = model%t - model%drift
      half = 0.5_wp * model%drift
      do k = 1, size(model%set%item)
         associate (b => model%set%item(k))
            record%place(:, k, record%points) = [b%x - model%drift * b%vx, b%y - model%drift * b%vy, &
                                                 b%angle - model%drift * b%spin]
            record%rate(:, k, record%points) = [b%vx, b%vy, b%spin]
            if (.not. b%fixed) record%rate(:, k, record%points) = record%rate(:, k, record%points) &
               - half * [b%fx / b%mass + model%pull(1), b%fy / b%mass + model%pull(2), b%moment / b%inertia]
         end associate
         record%place(1:2, k, record%points) = record%place(1:2, k, record%points) &
            - (model%base_place - model%drift * model%base)
         record%rate(1:2, k, record%points) = record%rate(1:2, k, record%points) - model%base
      end do
      record%energy(dem_energy_kinetic, record%points) = now%kinetic
      record%energy(dem_energy_potential, record%points) = now%potential
      record%energy(dem_energy_elastic, record%points) = now%elastic
      record%energy(dem_energy_friction, record%points) = now%friction
      record%energy(dem_energy_damping, record%points) = now%damping
      record%energy(dem_energy_mass_damping, record%points) = now%mass_damping
      record%energy(dem_energy_work, record%points) = now%work
      record%energy(dem_energy_residual, record%points) = energy_residual(now, record%start)
      record%energy(dem_energy_leapfrog, record%points) = now%leapfrog
   end subroutine write_down

   !> Has a body collapsed or left the domain?
   subroutine limits(model, options, record)
      type(block_model), intent(in) :: model
      type(run_options), intent(in) :: options
      type(run_record), intent(inout) :: record
      integer :: k
      real(wp) :: x, y
      do k = 1, size(model%set%item)
         associate (b => model%set%item(k))
            if (b%fixed) cycle
            x = b%x - model%base_place(1)
            y = b%y - model%base_place(2)
            if (options%collapse > 0.0_wp) then
               if (hypot(x - b%rest_x, y - b%rest_y) > options%collapse) record%reason = stop_collapse
            end if
            if (x < options%domain(1) .or. x > options%domain(2) .or. y < options%domain(3) &
               .or. y > options%domain(4)) record%reason = stop_left
            if (record%reason == stop_end) cycle
            record%blamed(1) = k
            return
         end associate
      end do
   end subroutine limits

end module dem_run
