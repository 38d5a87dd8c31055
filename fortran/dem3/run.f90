!> A run from rest to its end: settle under gravity, shake, watch, record.
module dem3_run
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : dem_energy_count, dem_energy_kinetic, dem_energy_potential, dem_energy_elastic, &
      dem_energy_friction, dem_energy_damping, dem_energy_mass_damping, dem_energy_work, dem_energy_residual, &
      dem_energy_leapfrog, stop_end => dem_stop_end, stop_collapse => dem_stop_collapse, &
      stop_blow_up => dem_stop_blow_up, stop_left => dem_stop_left, stop_rest => dem_stop_rest, &
      stop_step => dem_stop_step, stop_unsettled => dem_stop_unsettled
   use common_status, only : status_ok, status_cancelled, status_not_finite, status_out_of_memory
   use dem_loading, only : movement_end
   use dem3_bodies, only : body, spin_of, turn_freely
   use dem3_model, only : advance, critical_step, energy_now, energy_residual, energy_terms, search, set_distances, &
      solid_model
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: run_options, run_record, run_record_new, run_begin, run_on

   type :: run_options
      real(wp) :: end_time = 0.0_wp             !! [s]
      real(wp) :: step = 0.0_wp                 !! [s]; 0: the fraction of the critical step
      real(wp) :: fraction = 0.3_wp             !! of the critical step
      real(wp) :: settle_tolerance = 1.0e-6_wp  !! unbalanced force over weight
      integer :: settle_steps = 0               !! at most; 0: no settling
      real(wp) :: settlement = 0.0_wp           !! displacement by which a body falls instead of settling [m]; 0: none
      real(wp) :: collapse = 0.0_wp             !! displacement that counts as collapse [m]; 0: none
      real(wp) :: domain = 0.0_wp               !! displacement by which a body has left the scene [m]; 0: none
      real(wp) :: residual_limit = 0.1_wp       !! of the energy that went round
      logical :: stop_at_rest = .false.         !! once the ground is still
      integer :: threads = 1
   end type run_options

   !> What a run leaves. The reason is one of the list dem_stop
   type :: run_record
      real(wp), allocatable :: wanted(:)        !! (nt) output times [s]
      real(wp), allocatable :: time(:)          !! (nt) times of the nearest steps [s]
      real(wp), allocatable :: place(:, :, :)   !! (3, bodies, nt) centroids [m]
      real(wp), allocatable :: turn(:, :, :, :) !! (3, 3, bodies, nt) columns: the bodies' own axes
      real(wp), allocatable :: rate(:, :, :)    !! (6, bodies, nt) velocity, spin
      real(wp), allocatable :: energy(:, :)     !! (dem_energy_count, nt) [J]
      integer :: points = 0
      integer(c_int) :: reason = stop_end
      integer :: blamed = 0                     !! body that caused the stop, 0 none
      integer :: settling = 0                   !! steps it took
      integer :: searches = 0
      integer :: most_pairs = 0
      real(wp) :: critical = 0.0_wp             !! critical step at the start [s]
      real(wp) :: least_step = 0.0_wp           !! [s]
      real(wp) :: stop_time = 0.0_wp            !! [s]
      real(wp) :: residual = 0.0_wp             !! greatest, over the energy that went round
      type(energy_terms) :: start               !! energies as the shaking began
      real(wp) :: round = 0.0_wp                !! greatest energy that went round so far [J]
      integer :: calm_looks = 0                 !! in a row at which all was at rest
      logical :: paused = .false.               !! it has not come to its end and can go on
   end type run_record

   integer, parameter :: watch = 64             !! steps between two looks at limits

contains

   !> A record for `bodies` bodies at the times `wanted`
   subroutine run_record_new(bodies, wanted, record, status)
      integer, intent(in) :: bodies
      real(wp), intent(in) :: wanted(:)              !! [s]
      type(run_record), intent(out) :: record
      integer(c_int), intent(out) :: status
      integer :: failed
      allocate (record%wanted(size(wanted)), record%time(size(wanted)), record%place(3, bodies, size(wanted)), &
         record%turn(3, 3, bodies, size(wanted)), record%rate(6, bodies, size(wanted)), &
         record%energy(dem_energy_count, size(wanted)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed == 0) record%wanted(:) = wanted
   end subroutine run_record_new

   !> Settle a model and take the first step of its motion; paused then, unless it cannot run
   subroutine run_begin(model, options, record, status)
      type(solid_model), intent(inout) :: model
      type(run_options), intent(in) :: options
      type(run_record), intent(inout) :: record
      integer(c_int), intent(out) :: status
      integer :: k

      call set_distances(model)
      call search(model, status)
      if (status /= status_ok) return
      call critical_step(model, record%critical, status)
      if (status /= status_ok) return
      model%step = options%step
      if (.not. model%step > 0.0_wp) model%step = options%fraction * record%critical
      record%least_step = model%step
      if (model%step > record%critical) record%reason = stop_step
      if (record%reason /= stop_end) return
      do k = 1, size(model%set%item)
         model%set%item(k)%rest = model%set%item(k)%x
         model%set%item(k)%rest_turn = model%set%item(k)%turn
      end do
      if (options%settle_steps > 0) then
         call settle(model, options, record, status)
         if (status /= status_ok .or. record%reason /= stop_end) return
      end if
      do k = 1, size(model%set%item)
         model%set%item(k)%rest = model%set%item(k)%x
         model%set%item(k)%rest_turn = model%set%item(k)%turn
      end do
      model%shaking = .true.
      call several(model, 1, options%threads, record, status)
      if (status /= status_ok) return
      record%start = energy_now(model)
      call write_down(model, record, record%start)
      record%paused = .true.
   end subroutine run_begin

   !> Rest under gravity by kinetic damping: whenever the kinetic energy has passed a peak, all stops
   subroutine settle(model, options, record, status)
      type(solid_model), intent(inout) :: model
      type(run_options), intent(in) :: options
      type(run_record), intent(inout) :: record
      integer(c_int), intent(out) :: status
      integer, parameter :: batch = 8
      type(energy_terms) :: energy
      real(wp) :: before, step
      integer :: n, k

      status = status_ok
      model%shaking = .false.
      ! A tiny step of the run must not keep from rest what stands.
      step = model%step
      model%step = max(step, options%fraction * record%critical)
      before = 0.0_wp
      n = 0
      do while (n < options%settle_steps)
         call several(model, batch, options%threads, record, status)
         if (status /= status_ok) return
         n = n + batch
         energy = energy_now(model)
         if (.not. energy%kinetic <= huge(1.0_wp)) then
            status = status_not_finite
            return
         end if
         if (energy%kinetic < before) then
            do k = 1, size(model%set%item)
               model%set%item(k)%v = 0.0_wp
               model%set%item(k)%swing = 0.0_wp
            end do
            before = 0.0_wp
            if (unbalanced(model) < options%settle_tolerance) exit
         else
            before = energy%kinetic
         end if
         call limits(model, options%settlement, 0.0_wp, record)
         if (record%reason /= stop_end) exit
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
      end do
      model%step = min(model%step, step)   ! the step may have been cut as contacts formed
      record%settling = n
      if (n >= options%settle_steps .or. record%reason /= stop_end) then
         record%reason = stop_unsettled
         if (record%blamed == 0) record%blamed = most_unbalanced(model)
      end if
      do k = 1, model%pairs
         associate (pair => model%pair(k))
            pair%friction_loss = 0.0_wp
            pair%damping_loss = 0.0_wp
            pair%support_work = 0.0_wp
            do n = 1, pair%points
               pair%point(n)%dash_n = 0.0_wp
               pair%point(n)%dash_s = 0.0_wp
               pair%point(n)%force = pair%point(n)%force - pair%point(n)%dash
               pair%point(n)%dash = 0.0_wp
            end do
         end associate
      end do
      model%lost = 0.0_wp
      model%support_work = 0.0_wp
      model%set%item%work = 0.0_wp
      model%set%item%bounces = 0
      model%set%item%airborne = 0.0_wp
      model%t = 0.0_wp
      model%drift = 0.0_wp
      model%steps = 0
   end subroutine settle

   !> The mobile body on which forces and weight are farthest from balance
   pure function most_unbalanced(model) result(number)
      type(solid_model), intent(in) :: model
      integer :: number
      integer :: k
      real(wp) :: most, here
      number = 0
      most = -1.0_wp
      do k = 1, size(model%set%item)
         if (model%set%item(k)%fixed) cycle
         here = norm2(model%set%item(k)%force * model%set%item(k)%inverse_mass + model%gravity)
         if (here <= most) cycle
         most = here
         number = k
      end do
   end function most_unbalanced

   !> The mobile body of the greatest velocity
   pure function fastest(model) result(number)
      type(solid_model), intent(in) :: model
      integer :: number
      integer :: k
      real(wp) :: most
      number = 0
      most = -1.0_wp
      do k = 1, size(model%set%item)
         if (model%set%item(k)%fixed .or. .not. norm2(model%set%item(k)%v) > most) cycle
         most = norm2(model%set%item(k)%v)
         number = k
      end do
   end function fastest

   !> Greatest unbalanced force over weight, and moment over weight times radius
   pure function unbalanced(model) result(ratio)
      type(solid_model), intent(in) :: model
      real(wp) :: ratio
      real(wp) :: g
      integer :: k
      g = max(norm2(model%gravity), 1.0e-3_wp)
      ratio = 0.0_wp
      do k = 1, size(model%set%item)
         associate (b => model%set%item(k))
            if (b%fixed) cycle
            ratio = max(ratio, norm2(b%force / b%mass + model%gravity) / g, norm2(b%moment) / (b%mass * g * b%radius))
         end associate
      end do
   end function unbalanced

   !> Exactly `count` steps, with searches in between
   subroutine several(model, count, threads, record, status)
      type(solid_model), intent(inout) :: model
      integer, intent(in) :: count
      integer, intent(in) :: threads
      type(run_record), intent(inout) :: record
      integer(c_int), intent(out) :: status
      integer :: target_steps, k
      real(wp) :: critical
      status = status_ok
      target_steps = model%steps + count
      do while (model%steps < target_steps)
         call advance(model, target_steps - model%steps, threads)
         if (any(model%pair(:model%pairs)%lacks_memory)) then
            status = status_out_of_memory
            return
         end if
         if (.not. model%stale) cycle
         do k = 1, size(model%set%item)
            if (all(abs(model%set%item(k)%x) <= huge(1.0_wp))) cycle
            status = status_not_finite
            return
         end do
         call search(model, status)
         if (status /= status_ok) return
         record%searches = record%searches + 1
         record%most_pairs = max(record%most_pairs, model%pairs)
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
      type(solid_model), intent(inout) :: model
      type(run_options), intent(in) :: options
      integer, intent(in) :: steps                   !! 0: to the end
      type(run_record), intent(inout) :: record
      integer(c_int), intent(out) :: status
      type(energy_terms) :: energy
      integer :: n, before
      real(wp) :: quiet
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
            + energy%friction + energy%damping)
         record%residual = max(record%residual, &
            abs(energy_residual(energy, record%start)) / max(record%round, record%start%elastic, tiny(1.0_wp)))
         if (due) call write_down(model, record, energy)
         if (.not. record%residual <= options%residual_limit) then
            record%reason = stop_blow_up
            record%blamed = fastest(model)
         end if
         if (record%reason == stop_end) call limits(model, options%collapse, options%domain, record)
         if (options%stop_at_rest .and. model%t > quiet) then
            record%calm_looks = merge(record%calm_looks + 1, 0, &
               unbalanced(model) < 1.0e-3_wp .and. energy%kinetic < 1.0e-6_wp * record%round)
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

   !> State at the time of the last forces: half a step before the velocities, a step before the places
   subroutine write_down(model, record, now)
      type(solid_model), intent(in) :: model
      type(run_record), intent(inout) :: record
      type(energy_terms), intent(in) :: now
      integer :: k
      real(wp) :: half
      type(body) :: b
      if (record%points >= size(record%wanted)) return
      record%points = record%points + 1
      record%time(record%points) = model%t - model%drift
      half = 0.5_wp * model%drift
      do k = 1, size(model%set%item)
         b = model%set%item(k)
         if (.not. b%fixed) call turn_freely(b, -model%drift)
         record%place(:, k, record%points) = b%x - model%drift * b%v
         record%turn(:, :, k, record%points) = b%turn
         record%rate(:, k, record%points) = 0.0_wp
         if (b%fixed) cycle
         record%rate(1:3, k, record%points) = b%v - half * (b%force / b%mass + model%pull)
         record%rate(4:6, k, record%points) = spin_of(b, b%swing - half * b%moment)
      end do
      record%energy(:, record%points) = 0.0_wp
      record%energy(dem_energy_kinetic, record%points) = now%kinetic
      record%energy(dem_energy_potential, record%points) = now%potential
      record%energy(dem_energy_elastic, record%points) = now%elastic
      record%energy(dem_energy_friction, record%points) = now%friction
      record%energy(dem_energy_damping, record%points) = now%damping
      record%energy(dem_energy_mass_damping, record%points) = 0.0_wp
      record%energy(dem_energy_work, record%points) = now%work
      record%energy(dem_energy_residual, record%points) = energy_residual(now, record%start)
      record%energy(dem_energy_leapfrog, record%points) = now%leapfrog
   end subroutine write_down

   !> Has a body moved farther than what counts as collapse, or left the scene?
   subroutine limits(model, collapse, domain, record)
      type(solid_model), intent(in) :: model
      real(wp), intent(in) :: collapse          !! [m]; 0: no limit
      real(wp), intent(in) :: domain            !! [m]; 0: no limit
      type(run_record), intent(inout) :: record
      integer :: k
      real(wp) :: away
      do k = 1, size(model%set%item)
         if (model%set%item(k)%fixed) cycle
         away = norm2(model%set%item(k)%x - model%set%item(k)%rest)
         if (collapse > 0.0_wp .and. away > collapse) record%reason = stop_collapse
         if (domain > 0.0_wp .and. away > domain) record%reason = stop_left
         if (record%reason == stop_end) cycle
         record%blamed = k
         return
      end do
   end subroutine limits

end module dem3_run
