!> The event loop of sequentially linear analysis under loads A + lambda B (thesis 4.3.1).
!>
!> Each event: apply the last damage (change the factor along the path of its element, bring the displacements up to
!> date there), look for the admissible range of lambda wherever it can have changed enough (sla_regions), choose
!> the point that leaves it, record the state. The loop knows groups, not materials.
module sla_events
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : code_stick => sla_event_stick, &
      stop_none => sla_stop_none, stop_mechanism => sla_stop_mechanism, &
      stop_unbounded => sla_stop_unbounded, stop_all_empty => sla_stop_all_empty, &
      stop_displacement => sla_stop_displacement, stop_load => sla_stop_load, stop_fraction => sla_stop_fraction, &
      stop_lost => sla_stop_lost
   use common_status, only : status_ok, status_cancelled, status_out_of_memory, status_not_positive_definite, &
      status_beyond_strength
   use sla_assembly, only : add_event
   use sla_c_bindings, only : extrados_sparse_change, extrados_sparse_solve
   use sla_group, only : below, bound, event_vectors, point_group, scan_result, unbounded, most_entries, most_rank
   use sla_model, only : element_model, model_balance, model_factor, model_reactions, model_recorded, model_settled, &
      model_solve, held_work
   use sla_regions, only : levels, regions_bring, regions_calm, regions_home, regions_margins, regions_window
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: run_events, damage_overloaded, residual, scan_model, stop_rules, event_log, log_reals, log_integers

   integer, parameter :: log_reals = 11, log_integers = 4
   real(wp), parameter :: least_pivot = 1.0e-10_wp    !! of I - W' inv(K) W: below it the structure is a mechanism
   integer, parameter :: few = 100                    !! regions that are looked at sooner by one thread
   !> Multiplier of an event without equilibrium over the peak before, from which no state is sought any more
   real(wp), parameter :: farthest = 1.0e3_wp
   integer, parameter :: guard_every = 500
   real(wp), parameter :: most_residual = 1.0e-8_wp

   type :: stop_rules
      real(wp) :: lambda = unbounded               !! stage ends where it carries this multiplier
      real(wp) :: displacement = unbounded         !! of monitor 1, absolute [m]
      real(wp) :: fraction = -1.0_wp               !! of the peak multiplier, after it; negative: never
      real(wp) :: compliance = 1.0e6_wp            !! fb.ub over its first value: a mechanism
      logical :: refuse_overload = .false.         !! the first state must carry the constant loads
      !> Where no multiplier suits all points: all loads of the last state in equilibrium are scaled down together
      !> (intermittent proportional loading); else the constant loads stay and the greatest lower limit decides
      logical :: proportional = .false.
      !> The forces that a tooth sets free go onto the others at the load reached, before it grows again
      logical :: release = .false.
      real(wp) :: target = unbounded               !! of monitor 1 [m]: the stage ends in the state that has it
      real(wp) :: side = 0.0_wp                    !! +1: it is reached from below, -1: from above, 0: there is none
      real(wp) :: already = 0.0_wp                 !! loads like B that are on already, over B
   end type stop_rules

   !> What is recorded; monitors are weighted sums of equations
   type :: event_log
      integer :: count = 0
      !> lambda, upper limit, lower limit, stored, external, dissipated, crack energy [J], compliance fb.ub (where
      !> supports move with lambda their stiffness instead), residual, scale of all loads, force that moves supports [N]
      real(wp), allocatable :: reals(:, :)         !! (log_reals, room)
      !> point (1-based), code, tooth reached by it before, 1 in equilibrium
      integer(c_int), allocatable :: integers(:, :)  !! (log_integers, room)
      real(wp), allocatable :: monitors(:, :)      !! (monitors, room)
   end type event_log

contains

   !> Run up to `room` events and record them; the last one is chosen but not applied yet
   subroutine run_events(model, rules, first, equation, share, log, reason, status)
      type(element_model), intent(inout) :: model
      type(stop_rules), intent(in) :: rules
      integer(c_int), intent(in) :: first(:)      !! (monitors + 1) first entry of each monitor
      integer(c_int), intent(in) :: equation(:)   !! (entries), factor order
      real(wp), intent(in) :: share(:)
      type(event_log), intent(inout) :: log
      integer(c_int), intent(out) :: reason       !! of the list sla_stop
      integer(c_int), intent(out) :: status       !! status_cancelled leaves a valid log
      type(scan_result) :: found
      type(bound) :: scaled
      real(wp), allocatable :: ratio(:)
      real(wp) :: reached, at
      logical :: equilibrium, driven, met
      integer :: info, place(2)

      driven = any(abs(model%moved(:, 2)) > 0.0_wp)
      at = 0.0_wp
      reason = stop_none
      status = status_out_of_memory
      log%count = 0
      allocate (ratio(size(first) - 1), stat=info)
      if (info /= 0) return
      status = status_ok
      call watch(model, first, equation, share, ratio)
      do while (log%count < size(log%reals, 2))
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
         if (rules%release .and. model%pending(1) /= 0) call hold_state(model, status)
         if (status /= status_ok) return
         if (model%pending(1) /= 0) then
            place = model%pending(1:2)
            call apply_event(model, reason, status)
            if (model%slides .and. status == status_ok .and. reason == stop_none) call slide(model, place, reason, &
               status)
            if (status /= status_ok .or. reason /= stop_none) return
         end if
         if (model%releasing) then
            call set_free(model, found, status)
            if (status /= status_ok) return
            call record(model, found, .not. model%releasing, first, equation, share, ratio, log)
            if (too_soft(model, driven, rules%compliance)) reason = stop_mechanism
            if (reason /= stop_none) return
            cycle
         end if
         call scan_model(model, found, status)
         if (status /= status_ok) return
         if (size(model%moved, 1) > 0) call follow_supports(model)
         model%hot(:, 1) = [found%hi%group, found%hi%point]
         model%hot(:, 2) = [found%lo%group, found%lo%point]
         equilibrium = found%empty%point == 0 .and. .not. crossed(found)
         if (rules%refuse_overload .and. .not. model%recorded .and. .not. equilibrium) then
            status = status_beyond_strength
            return
         end if
         if (.not. found%bounded) reason = stop_unbounded
         model%scale = 1.0_wp
         scaled = bound()
         if (rules%proportional .and. .not. equilibrium .and. found%bounded) call scan_scaled(model, scaled, status)
         if (status /= status_ok) return
         call meet_target(model, rules, found, first, equation, share, ratio(1), at, met)
         if (equilibrium .and. rules%lambda < unbounded .and. found%hi%value >= rules%lambda .and. &
             found%lo%value <= rules%lambda) then
            reason = stop_load
         else if (equilibrium .and. met) then
            reason = stop_displacement
         else if (scaled%point /= 0) then
            model%scale = scaled%value
            scaled%value = model%lambda_held
            call choose(model, scaled)
         else if (found%empty%point /= 0) then
            found%empty%value = model%lambda
            if (found%hi%point == 0 .and. found%lo%point == 0) reason = stop_all_empty
            call choose(model, found%empty)
         else if (equilibrium .and. found%hi%value < unbounded) then
            call choose(model, found%hi)
         else if (found%lo%value > -unbounded .and. .not. equilibrium) then
            call choose(model, found%lo)
         else
            reason = stop_unbounded    ! only lower limits: the load can grow for ever
         end if
         if (reason == stop_load .or. reason == stop_displacement) then
            model%pending = 0
            call account(model, merge(rules%lambda, at, reason == stop_load), status)
         else if (reason == stop_unbounded) then
            return
         else
            call account(model, model%lambda, status)
         end if
         if (status /= status_ok) return
         call record(model, found, equilibrium, first, equation, share, ratio, log)
         if (reason /= stop_none) return
         if (equilibrium) then
            model%lambda_held = model%lambda
            reached = merge(log%reals(log_reals, log%count), model%lambda + rules%already, driven)
            if (reached > model%peak) then
               model%peak = reached
               model%peak_displacement = log%monitors(1, log%count)
            end if
            if (abs(log%monitors(1, log%count)) >= rules%displacement) reason = stop_displacement
            ! A drop on the way back from a small crack is no end: the wall must have gone further than at its peak.
            if (rules%fraction >= 0.0_wp .and. model%peak > 0.0_wp .and. &
                reached < rules%fraction * model%peak .and. &
                (log%monitors(1, log%count) - model%peak_displacement) * model%slope > 0.0_wp) reason = stop_fraction
         end if
         ! Where no multiplier brings a state back, limits run away
         if (model%peak > 0.0_wp .and. .not. equilibrium) then
            reached = merge(abs(model%lambda_held), model%peak, driven)
            if (.not. abs(model%lambda) <= farthest * reached) reason = stop_lost
         end if
         ! Joints that slide make the structure unsymmetric: it may answer the load the other way, until what slides
         ! back sticks, at once
         if (too_soft(model, driven, rules%compliance)) then
            if (model%pending(3) /= code_stick) reason = stop_mechanism
         end if
         if (reason /= stop_none) return
      end do
   end subroutine run_events

   !> Has the compliance to the growing load grown by a ratio; supports that move also move what has no stiffness left,
   !> unless the constant loads carry it away
   pure function too_soft(model, driven, ratio) result(yes)
      type(element_model), intent(in) :: model
      logical, intent(in) :: driven
      real(wp), intent(in) :: ratio
      logical :: yes
      if (driven) then
         yes = model%first_constant > 0.0_wp .and. .not. model%work_now(1) <= ratio * model%first_constant
      else
         yes = .not. abs(merge(model%work_now(3), model%work(3), model%releasing)) <= ratio * model%first_compliance
      end if
   end function too_soft

   !> Keep the state in which a tooth is about to pass, from which its forces are set free
   subroutine hold_state(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: info
      call bring_all(model, status)
      if (status /= status_ok) return
      model%tree%settled = .false.
      if (.not. allocated(model%from)) then
         allocate (model%from, mold=model%ua, stat=info)
         if (info /= 0) status = status_out_of_memory
         if (info /= 0) return
      end if
      if (model%releasing) then
         model%from(:) = model%from + model%released * (model%ua + model%lambda * model%ub - model%from)
      else
         model%from(:) = model%ua + model%lambda * model%ub
      end if
      model%releasing = .true.
      model%released = 0.0_wp
   end subroutine hold_state

   !> Go the straight way from the state held to that of equilibrium at the load reached, up to the first point that
   !> leaves its strength on it, which is the next to be damaged; model%releasing is false at the end of the way
   subroutine set_free(model, found, status)
      type(element_model), intent(inout) :: model
      type(scan_result), intent(out) :: found
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: way(:)
      real(wp) :: load, excess, total, part
      integer :: g, k, n, info

      n = model%equations
      call bring_all(model, status)
      if (status /= status_ok) return
      model%tree%settled = .false.
      if (size(model%moved, 1) > 0) call follow_supports(model)
      allocate (way, mold=model%ua, stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      way(:) = model%ua + model%lambda * model%ub - model%from
      do k = 1, size(model%list)
         model%list(k) = k
      end do
      found = scan_result()
      call scan_list(model, model%from, way, model%noise * max(abs(model%lambda), 1.0_wp), scan_result(), 1, &
         size(model%list), found)
      part = 1.0_wp
      if (found%empty%point /= 0) then
         part = 0.0_wp
         call choose(model, found%empty)
      else if (found%hi%value < 1.0_wp) then
         part = max(found%hi%value, 0.0_wp)
         call choose(model, found%hi)
      end if
      model%lambda = model%lambda_recorded
      model%released = part
      ! Energy: the loads go on at their value; what is above that of equilibrium is lost on the way
      model%force = 0.0_wp
      do g = 1, size(model%holders)
         call model%holders(g)%group%force(way, model%force)
      end do
      excess = 0.5_wp * dot_product(way(1:n), model%force(1:n))
      load = dot_product(model%fa(1:n) + model%lambda * model%fb(1:n), way(1:n))
      total = model%work_now(1) + model%lambda * (2.0_wp * model%work_now(2) + model%lambda * model%work_now(3))
      model%external = model%external + part * load
      model%dissipated = model%dissipated + excess * (1.0_wp - (1.0_wp - part)**2)
      model%free = [0.5_wp * total - (1.0_wp - part) * load + (1.0_wp - part)**2 * excess, &
         model%support(1, 2) + model%lambda * model%support(2, 2) - &
         (1.0_wp - part) * dot_product(model%force(n + 1:), model%moved(:, 2))]
      model%event%rank = 0
      model%releasing = part < 1.0_wp
      if (model%releasing) return
      model%work = model%work_now
      model%cross = model%work_now(2)
      model%support_was = model%support
   end subroutine set_free

   !> The multiplier at which monitor 1 has its target, where all points admit it
   pure subroutine meet_target(model, rules, found, first, equation, share, ratio, lambda, met)
      type(element_model), intent(in) :: model
      type(stop_rules), intent(in) :: rules
      type(scan_result), intent(in) :: found
      integer(c_int), intent(in) :: first(:)
      integer(c_int), intent(in) :: equation(:)
      real(wp), intent(in) :: share(:)
      real(wp), intent(in) :: ratio         !! of monitor 1, see watch
      real(wp), intent(out) :: lambda
      logical, intent(out) :: met
      real(wp) :: start, slope
      integer :: i
      met = .false.
      lambda = 0.0_wp
      if (.not. abs(rules%side) > 0.0_wp) return
      start = 0.0_wp
      slope = 0.0_wp
      if (abs(ratio) > 0.0_wp .and. .not. model%slides) then
         start = ratio * (model%work_now(2) - model%support(2, 1))
         slope = ratio * (model%work_now(3) - model%support(2, 2))
      else
         do i = int(first(1)), int(first(2)) - 1
            start = start + share(i) * model%ua(equation(i))
            slope = slope + share(i) * model%ub(equation(i))
         end do
      end if
      if (.not. rules%side * slope > 0.0_wp) return
      lambda = (rules%target - start) / slope
      met = found%empty%point == 0 .and. lambda >= found%lo%value .and. lambda <= found%hi%value
   end subroutine meet_target

   !> The forces of moved supports and their part in the work after an event
   subroutine follow_supports(model)
      type(element_model), intent(inout) :: model
      real(wp) :: was(2, 2)
      was = model%support
      call model_reactions(model)
      associate (change => model%support - was)
         model%work_now = model%work_now + [2.0_wp * change(1, 1), change(1, 2) + change(2, 1), 2.0_wp * change(2, 2)]
      end associate
   end subroutine follow_supports

   !> Do the limits leave no multiplier, by more than rounding? A joint that closes at zero stress would open again at
   !> the same load, then close, many times over.
   pure function crossed(found) result(yes)
      type(scan_result), intent(in) :: found
      logical :: yes
      real(wp), parameter :: rounding = 1.0e-9_wp
      yes = found%hi%value < found%lo%value
      if (yes .and. found%hi%value < unbounded .and. found%lo%value > -unbounded) yes = &
         found%lo%value - found%hi%value > rounding * max(abs(found%hi%value), abs(found%lo%value))
   end function crossed

   !> Limits over all points; regions that cannot hold the least ones are left out. The same for any number of
   !> threads
   subroutine scan_model(model, found, status)
      type(element_model), intent(inout) :: model
      type(scan_result), intent(out) :: found
      integer(c_int), intent(out) :: status
      integer :: k, near, count
      logical :: calm

      found = scan_result()
      associate (tree => model%tree)
         count = size(tree%part)
         if (tree%settled) then
            ! First what is surely concerned, which gives limits to ask the others with.
            do k = 1, size(model%hot, 2)
               if (model%hot(1, k) > 0) model%wanted(element_region(model, model%hot(:, k))) = .true.
            end do
            call bring_wanted(model, near, status)
            if (status /= status_ok) return
            call scan_list(model, model%ua, model%ub, model%noise, guess_limits(model), 1, near, found)
            if (found%hi%value < tree%lambda(levels) .and. found%lo%value > tree%lambda(1) .and. &
                found%hi%value > tree%lambda(1) .and. found%lo%value < tree%lambda(levels)) then
               count = near
               k = size(tree%part)
               do while (k >= 1)
                  if (tree%part(k)%seen /= tree%now) then
                     call regions_calm(tree, k, model%ua, model%ub, found%hi%value, found%lo%value, calm)
                     if (calm) then
                        k = tree%part(k)%lowest - 1
                        cycle
                     end if
                     call bring(model, k, count, status)
                     if (status /= status_ok) return
                  end if
                  k = k - 1
               end do
               call scan_list(model, model%ua, model%ub, model%noise, guess_limits(model), near + 1, count, found)
               call regions_margins(tree, model%holders, model%ua, model%ub)
               return
            end if
         end if
         ! All are brought up to date and looked at, then may wait again.
         call bring_all(model, status)
         if (status /= status_ok) return
         found = scan_result()
         do k = 1, count
            model%list(k) = k
         end do
         call scan_list(model, model%ua, model%ub, model%noise, guess_limits(model), 1, count, found)
         tree%settled = tree%measured .and. found%hi%value < unbounded .and. found%lo%value > -unbounded
         if (.not. tree%settled) return
         call regions_window(tree, found%hi%value, found%lo%value)
         call regions_margins(tree, model%holders, model%ua, model%ub)
      end associate
   end subroutine scan_model

   !> The region of the first freedom of a point's element
   pure function element_region(model, place) result(k)
      type(element_model), intent(in) :: model
      integer, intent(in) :: place(2)        !! group and point
      integer :: k
      k = size(model%tree%part)
      select type (group => model%holders(place(1))%group)
      class is (point_group)
         k = regions_home(model%tree, group%equation(:, 1 + (place(2) - 1) / (group%points / group%elements)))
      end select
   end function element_region

   !> Bring the wanted regions and those above them up to date, unless they are; all that are go to the list
   subroutine bring_wanted(model, count, status)
      type(element_model), intent(inout) :: model
      integer, intent(out) :: count
      integer(c_int), intent(out) :: status
      integer :: k
      status = status_ok
      count = 0
      associate (tree => model%tree)
         do k = 1, size(tree%part)
            if (.not. model%wanted(k) .and. tree%part(k)%seen /= tree%now) cycle
            if (tree%part(k)%parent > 0) model%wanted(tree%part(k)%parent) = .true.
         end do
         do k = size(tree%part), 1, -1
            if (tree%part(k)%seen == tree%now) then
               count = count + 1
               model%list(count) = k
            else if (model%wanted(k)) then
               call bring(model, k, count, status)
               if (status /= status_ok) return
            end if
         end do
         model%wanted(:) = model%watched
      end associate
   end subroutine bring_wanted

   !> Bring one region up to date and put it on the list
   subroutine bring(model, k, count, status)
      type(element_model), intent(inout) :: model
      integer, intent(in) :: k
      integer, intent(inout) :: count
      integer(c_int), intent(out) :: status
      call regions_bring(model%tree, k, model%handle, .false., model%ua, model%ub, model%z, status)
      count = count + 1
      model%list(count) = k
   end subroutine bring

   !> Bring all regions up to date
   subroutine bring_all(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: k, count
      status = status_ok
      count = 0
      do k = size(model%tree%part), 1, -1
         if (model%tree%part(k)%seen /= model%tree%now) call bring(model, k, count, status)
         if (status /= status_ok) return
      end do
      model%tree%part(:)%patience = 0
      model%tree%part(:)%failed = 0
   end subroutine bring_all

   !> One iteration of an incremental analysis: in each element the most overloaded point at a multiplier loses a tooth,
   !> all at once; then the factor and the displacements are made anew
   subroutine damage_overloaded(model, lambda, count, status)
      type(element_model), intent(inout) :: model    !! all its displacements are those of a solution
      real(wp), intent(in) :: lambda
      integer, intent(out) :: count                  !! points damaged
      integer(c_int), intent(out) :: status          !! not_positive_definite: a mechanism
      real(wp), parameter :: tolerance = 1.0e-9_wp
      type(scan_result) :: found
      type(event_vectors) :: event
      type(bound) :: worst
      real(wp) :: ratio
      integer(c_int) :: node, direction
      integer :: g, e, i, tooth

      count = 0
      status = status_ok
      do g = 1, size(model%holders)
         select type (group => model%holders(g)%group)
         class is (point_group)
            do e = 1, group%elements
               found = scan_result()
               call group%scan(e, e, model%ua, model%ub, lambda, model%noise, found)
               worst = bound()
               if (found%empty%point /= 0) then
                  worst = found%empty
               else if (found%hi%point /= 0 .and. found%hi%value < lambda - tolerance * abs(lambda)) then
                  worst = found%hi
               else if (found%lo%point /= 0 .and. found%lo%value > lambda + tolerance * abs(lambda)) then
                  worst = found%lo
               end if
               if (worst%point == 0) cycle
               call group%damage(worst%point, worst%code, lambda, model%ua, model%ub, event, tooth)
               count = count + 1
               do i = 1, event%rank
                  model%cracked = model%cracked + 0.5_wp * event%sign(i) * &
                     along(event, i, model%ua, model%ub, lambda)**2
               end do
            end do
         end select
      end do
      if (count == 0) return
      call model_factor(model, node, direction, ratio, status)
      if (status == status_ok) call model_solve(model, status)
   end subroutine damage_overloaded

   !> The point that limits the loads of the last state in equilibrium if all of them grow together from nothing
   subroutine scan_scaled(model, limit, status)
      type(element_model), intent(inout) :: model
      type(bound), intent(out) :: limit              !! share of the loads; point 0 where nothing limits them
      integer(c_int), intent(out) :: status
      type(scan_result) :: found
      real(wp), allocatable :: zero(:), u(:)
      integer :: k, info

      call bring_all(model, status)
      if (status /= status_ok) return
      model%tree%settled = .false.                   ! the margins were those of before
      allocate (zero, u, mold=model%ua, stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      zero(:) = 0.0_wp
      u(:) = model%ua + model%lambda_held * model%ub
      do k = 1, size(model%list)
         model%list(k) = k
      end do
      found = scan_result()
      call scan_list(model, zero, u, model%noise * max(abs(model%lambda_held), 1.0_wp), scan_result(), &
         1, size(model%list), found)
      if (found%hi%point /= 0) limit = found%hi
   end subroutine scan_scaled

   !> Limits over the listed regions, joined to those found before
   subroutine scan_list(model, ua, ub, noise, near, first, last, found)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: noise
      type(scan_result), intent(in) :: near          !! limits of some points, loosened: they spare others the roots
      integer, intent(in) :: first
      integer, intent(in) :: last
      type(scan_result), intent(inout) :: found
      type(scan_result) :: guess
      integer :: i, k

      guess = near
      call loosen(found, guess)
      !$omp parallel do schedule(static) default(none) &
      !$omp shared(model, ua, ub, noise, guess, first, last) private(i, k) &
      !$omp num_threads(model%threads) if(model%threads > 1 .and. last - first > few)
      do i = first, last
         model%part(i) = guess
         associate (part => model%tree%part(model%list(i)))
            do k = part%run + 1, part%run + part%runs
               select type (group => model%holders(model%tree%run(1, k))%group)
               class is (point_group)
                  call scan_run(group, model%tree%run(:, k), ua, ub, model%lambda, noise, model%part(i))
               end select
            end do
         end associate
      end do
      !$omp end parallel do
      do i = first, last
         associate (part => model%part(i))
            found%bounded = found%bounded .or. part%bounded
            if (part%hi%point /= 0 .and. wins(part%hi, part%hi%value, found%hi, found%hi%value)) found%hi = part%hi
            if (part%lo%point /= 0 .and. wins(part%lo, -part%lo%value, found%lo, -found%lo%value)) found%lo = part%lo
            if (part%empty%point == 0) cycle
            if (found%empty%point == 0 .or. part%empty%value > found%empty%value .or. &
                (.not. part%empty%value < found%empty%value .and. earlier(part%empty, found%empty))) then
               found%empty = part%empty
            end if
         end associate
      end do
   end subroutine scan_list

   !> Limits over one run of elements; what it finds carries the group's number
   subroutine scan_run(group, run, ua, ub, lambda, noise, found)
      class(point_group), intent(in) :: group
      integer, intent(in) :: run(3)          !! group, first and last element
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      type(scan_result), intent(inout) :: found
      type(scan_result) :: new
      new = found
      call group%scan(run(2), run(3), ua, ub, lambda, noise, new)
      ! The group gives new limits no number.
      if (new%hi%group == 0 .and. new%hi%point /= 0) new%hi%group = run(1)
      if (new%lo%group == 0 .and. new%lo%point /= 0) new%lo%group = run(1)
      if (new%empty%group == 0 .and. new%empty%point /= 0) new%empty%group = run(1)
      found = new
   end subroutine scan_run

   !> Does a limit take the place of another one: it is less, or the same of an earlier point
   pure function wins(new, value, old, least) result(better)
      type(bound), intent(in) :: new
      real(wp), intent(in) :: value          !! of the new, the least wins
      type(bound), intent(in) :: old
      real(wp), intent(in) :: least          !! of the old
      logical :: better
      better = below(value, least)
      if (.not. better .and. old%point /= 0 .and. .not. below(least, value)) better = earlier(new, old)
   end function wins

   !> Does a point come before another
   pure function earlier(a, b) result(first)
      type(bound), intent(in) :: a, b
      logical :: first
      first = a%group < b%group .or. (a%group == b%group .and. a%point < b%point)
   end function earlier

   !> Loosened limits of the points that set the last ones: those of the point damaged last are near the new ones
   function guess_limits(model) result(guess)
      type(element_model), intent(in) :: model
      type(scan_result) :: guess
      type(scan_result) :: found
      integer :: k, g, e

      guess = scan_result()
      do k = 1, size(model%hot, 2)
         g = model%hot(1, k)
         if (g == 0) cycle
         select type (group => model%holders(g)%group)
         class is (point_group)
            e = 1 + (model%hot(2, k) - 1) / (group%points / group%elements)
            found = scan_result()
            call group%scan(e, e, model%ua, model%ub, model%lambda, model%noise, found)
            call loosen(found, guess)
         end select
      end do
   end function guess_limits

   !> Limits that leave room for equals of those found
   pure subroutine loosen(found, guess)
      type(scan_result), intent(in) :: found
      type(scan_result), intent(inout) :: guess
      real(wp), parameter :: room = 1.0e-9_wp
      if (found%hi%point /= 0) guess%hi%value = min(guess%hi%value, found%hi%value + &
         max(room * abs(found%hi%value), tiny(room)))
      if (found%lo%point /= 0) guess%lo%value = max(guess%lo%value, found%lo%value - &
         max(room * abs(found%lo%value), tiny(room)))
   end subroutine loosen

   !> A monitor on which the reference load does its work follows from that work. The regions of the others are
   !> brought up to date in each event
   subroutine watch(model, first, equation, share, ratio)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(in) :: first(:)
      integer(c_int), intent(in) :: equation(:)
      real(wp), intent(in) :: share(:)
      real(wp), intent(out) :: ratio(:)           !! (monitors) to the work, 0: not of this kind [1/N]
      real(wp), parameter :: same = 1.0e-12_wp
      integer :: i, k, n, greatest
      n = model%equations
      model%watched = .false.
      call watch_supports(model)
      do k = 1, size(ratio)
         model%force = 0.0_wp
         do i = int(first(k)), int(first(k + 1)) - 1
            model%force(equation(i)) = model%force(equation(i)) + share(i)
         end do
         model%force(0) = 0.0_wp
         greatest = maxloc(abs(model%fb), dim=1) - 1
         ratio(k) = 0.0_wp
         if (abs(model%fb(greatest)) > 0.0_wp) ratio(k) = model%force(greatest) / model%fb(greatest)
         if (maxval(abs(model%force(0:n) - ratio(k) * model%fb)) <= same * maxval(abs(model%force))) then
            if (.not. any(abs(model%force(n + 1:)) > 0.0_wp)) cycle
         end if
         ratio(k) = 0.0_wp
         do i = int(first(k)), int(first(k + 1)) - 1
            if (equation(i) > 0 .and. equation(i) <= n) model%watched(model%tree%of(equation(i))) = .true.
         end do
      end do
      model%wanted = model%watched
   end subroutine watch

   !> The regions beside moved supports are brought up to date in each event
   subroutine watch_supports(model)
      type(element_model), intent(inout) :: model
      integer :: i, j, q
      do i = 1, size(model%beside, 2)
         associate (e => model%beside(2, i), group => model%holders(model%beside(1, i))%group)
            do j = 1, group%freedoms
               q = int(group%equation(j, e))
               if (q > 0 .and. q <= model%equations) model%watched(model%tree%of(q)) = .true.
            end do
         end associate
      end do
   end subroutine watch_supports

   !> The point to damage next and its multiplier
   pure subroutine choose(model, chosen)
      type(element_model), intent(inout) :: model
      type(bound), intent(in) :: chosen
      model%pending = [chosen%group, chosen%point, chosen%code]
      model%lambda = chosen%value
   end subroutine choose

   !> Damage the pending point; the factor follows, and the displacements on the path of its element
   subroutine apply_event(model, reason, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: reason
      integer(c_int), intent(out) :: status
      real(wp) :: w(most_entries * most_rank), b(most_entries * 2), before(2, most_rank), after(2), least
      integer(c_int) :: index0(most_entries), sense(most_rank)
      integer :: i, k, n, f, tooth, pass, changes, path, unknown(most_entries)

      reason = stop_none
      status = status_ok
      select type (group => model%holders(model%pending(1))%group)
      class is (point_group)
         if (model%releasing) then
            call group%damage(model%pending(2), model%pending(3), 0.0_wp, model%from, model%ub, model%event, tooth)
         else
            call group%damage(model%pending(2), model%pending(3), model%lambda, model%ua, model%ub, model%event, tooth)
         end if
      end select
      model%pending = 0
      model%events = model%events + 1
      model%tree%now = model%tree%now + 1
      associate (event => model%event, tree => model%tree)
         if (event%rank == 0) return
         model%cracked = model%cracked + event%crack
         n = event%entries
         do i = 1, event%rank
            before(:, i) = [component(event, i, model%ua), component(event, i, model%ub)]
            model%before(i) = model%scale * (before(1, i) + model%lambda * before(2, i)) - event%origin(i)
            if (model%releasing) then
               model%before(i) = component(event, i, model%from)
               model%dissipated = model%dissipated + 0.5_wp * event%sign(i) * model%before(i)**2
            end if
            if (event%cracks) model%cracked = model%cracked + 0.5_wp * event%sign(i) * model%before(i)**2
         end do
         if (model%refactor) then
            call add_event(event, model%start, model%row, model%value)
            call model_solve(model, status)
            if (status == status_not_positive_definite) then
               status = status_ok
               reason = stop_mechanism
            end if
            return
         end if
         model%origin_energy = model%origin_energy + event%shift
         f = 0
         do i = 1, n
            if (event%index(i) > model%equations) cycle     ! of a support that moves
            f = f + 1
            unknown(f) = i
         end do
         ! (K - W S W') du = W S (W' u - origin - hold). Stiffening first: no way-station is less definite than the
         ! ends.
         changes = 0
         b = 0.0_wp
         do pass = 1, 2
            do i = 1, event%rank
               if ((event%sign(i) > 0.0_wp) .eqv. (pass == 1)) cycle
               w(changes * f + 1:changes * f + f) = event%w(unknown(1:f), i)
               changes = changes + 1
               sense(changes) = int(-sign(1.0_wp, event%sign(i)), c_int)
               b(1:f) = b(1:f) + event%sign(i) * (before(1, i) - event%origin(i) - event%hold(1, i)) * &
                  event%w(unknown(1:f), i)
               b(f + 1:2 * f) = b(f + 1:2 * f) + event%sign(i) * (before(2, i) - event%hold(2, i)) * &
                  event%w(unknown(1:f), i)
               do k = 1, n
                  associate (to => event%index(k), w_k => event%w(k, i))
                     model%fo(to) = model%fo(to) - event%sign(i) * event%origin(i) * w_k
                     model%fh(to, :) = model%fh(to, :) - event%sign(i) * event%hold(:, i) * w_k
                  end associate
               end do
            end do
         end do
         if (f > 0) then
            path = 0
            k = regions_home(tree, event%index(1:n))
            do while (k > 0)
               path = path + 1
               model%list(path) = k
               model%z(tree%part(k)%first:tree%part(k)%last, :) = 0.0_wp   ! part of a region may lie off the path
               k = tree%part(k)%parent
            end do
            index0(1:f) = event%index(unknown(1:f)) - 1_c_int
            status = extrados_sparse_change(model%handle, int(changes, c_int), sense, int(f, c_int), index0, w, &
               2_c_int, b, model%z, least)
            if (status == status_not_positive_definite .or. (status == status_ok .and. least < least_pivot)) then
               status = status_ok
               reason = stop_mechanism
            end if
            if (status /= status_ok .or. reason /= stop_none) return
            ! From the root down to the element
            do i = path, 1, -1
               call regions_bring(tree, model%list(i), model%handle, .true., model%ua, model%ub, model%z, status)
               if (status /= status_ok) return
            end do
         end if
         model%friction%current = .false.
         do i = 1, merge(0, event%rank, model%slides)   ! sliding friction lets the loads do other work, see account
            after = [component(event, i, model%ua), component(event, i, model%ub)]
            model%work_now = model%work_now + event%sign(i) * &
               [before(1, i) * after(1), before(1, i) * after(2), before(2, i) * after(2)]
         end do
      end associate
      if (mod(model%events, guard_every) == 0) call guard_residual(model, status)
   end subroutine apply_event

   !> What slides balances with what changed, and has come as far as it is
   subroutine slide(model, place, reason, status)
      type(element_model), intent(inout) :: model
      integer, intent(in) :: place(2)          !! group and point of the event
      integer(c_int), intent(inout) :: reason
      integer(c_int), intent(out) :: status
      integer :: g
      call bring_all(model, status)
      if (status /= status_ok) return
      call model_balance(model, place, status)
      if (status == status_not_positive_definite) then
         status = status_ok
         reason = stop_mechanism
      end if
      do g = 1, size(model%holders)
         select type (group => model%holders(g)%group)
         class is (point_group)
            call group%advance(model%lambda, model%ua, model%ub)
         end select
      end do
   end subroutine slide

   !> Residuals of both displacements by the elements; refine, then factorise anew, only where they ask for it
   subroutine guard_residual(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer(c_int) :: node, direction
      real(wp) :: ratio
      integer :: n

      n = model%equations
      call bring_all(model, status)
      if (status /= status_ok) return
      model%guard(1) = model%guard(1) + 1
      call residual(model, model%ua, model%ub)
      if (model%residual <= most_residual) then
         call model_settled(model)
         return
      end if
      model%guard(2) = model%guard(2) + 1
      status = extrados_sparse_solve(model%handle, 2_c_int, model%z)
      if (status /= status_ok) return
      model%ua(1:n) = model%ua(1:n) + model%z(:, 1)
      model%ub(1:n) = model%ub(1:n) + model%z(:, 2)
      call model_settled(model)
      call residual(model, model%ua, model%ub)
      if (model%residual <= most_residual) return
      model%guard(3) = model%guard(3) + 1
      call model_factor(model, node, direction, ratio, status)
      if (status == status_ok) call model_solve(model, status)
      if (status == status_ok) call residual(model, model%ua, model%ub)
   end subroutine guard_residual

   !> Residual forces into z, the larger relative norm into made%residual
   subroutine residual(model, ua, ub)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp) :: load
      integer :: k, g, n
      n = model%equations
      model%residual = 0.0_wp
      do k = 1, 2
         model%force = 0.0_wp
         do g = 1, size(model%holders)
            if (k == 1) call model%holders(g)%group%force(ua, model%force)
            if (k == 2) call model%holders(g)%group%force(ub, model%force)
         end do
         if (k == 1) model%z(:, k) = model%fa(1:n) + model%fo(1:n) + model%fh(1:n, 1) - model%force(1:n)
         if (k == 2) model%z(:, k) = model%fb(1:n) + model%fh(1:n, 2) - model%force(1:n)
         load = merge(norm2(model%fa), norm2(model%fb), k == 1) + norm2(model%reaction(:, k))
         if (load > 0.0_wp) model%residual = max(model%residual, norm2(model%z(:, k)) / load)
      end do
   end subroutine residual

   !> Energy ledger up to the state lambda: external work by the trapezium between successive states,
   !> dissipation at the damaged points alone; the stored energy must close the balance
   subroutine account(model, lambda, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: lambda
      integer(c_int), intent(out) :: status
      logical :: counted
      real(wp) :: now(3), held(2), after, was, s, t, cross, free(4), before(4)
      integer :: i, n

      was = model%lambda_recorded
      s = model%scale
      t = model%scale_recorded
      if (model%slides) then
         held = held_work(model, lambda)
         n = model%equations
         now = [dot_product(model%fa, model%ua(0:n)) + model%support(1, 1), &
            dot_product(model%fa, model%ub(0:n)) + model%support(1, 2), &
            dot_product(model%fb, model%ub(0:n)) + model%support(2, 2)]
         ! fa.ub too, but for friction that slides
         cross = dot_product(model%fb, model%ua(0:n)) + model%support(2, 1)
      else
         held = 0.0_wp
         now = model%work_now
         cross = now(2)
      end if
      counted = model%recorded
      if (.not. model%recorded) then
         ! The first state of a stage: the constant loads are on, or were brought on by the stage before.
         ! From there on A does the work lambda fa.ub, also beside the forces of friction, where fb.ua is another.
         if (model%carried) model%external = model%external - 0.5_wp * now(1)
         model%external = model%external + 0.5_wp * s**2 * (now(1) + lambda * (now(2) + &
            merge(now(2), cross, model%carried) + lambda * now(3)))
         model%recorded = .true.
      else
         associate (event => model%event)
            do i = 1, event%rank
               after = s * along(event, i, model%ua, model%ub, lambda) - event%origin(i)
               model%dissipated = model%dissipated + 0.5_wp * event%sign(i) * (model%before(i) * after - &
                  event%origin(i)**2)
            end do
            model%dissipated = model%dissipated - event%shift
         end associate
         ! Work of the held forces, (fh_old + fh_new) . (u_new - u_old) / 2
         if (model%slides) model%dissipated = model%dissipated - model%excess - 0.5_wp * dot_product( &
            model%fh(:, 1) + lambda * model%fh(:, 2) + model%f_before, model%ua + lambda * model%ub - model%u_before)
         ! (f_old + f_new) . (u_new - u_old) / 2 with f = s (A + lambda B), u = s (ua + lambda ub); the loads alone
         free = [now, cross] - [model%support(1, 1), model%support(1, 2), model%support(2, 2), model%support(2, 1)]
         before = [model%work, model%cross] - [model%support_was(1, 1), model%support_was(1, 2), &
            model%support_was(2, 2), model%support_was(2, 1)]
         model%external = model%external + 0.5_wp * ( &
            s * (s + t) * free(1) + s * (s + t) * lambda * free(2) &
            + s * (s * lambda + t * was) * (free(4) + lambda * free(3)) &
            - t * (s + t) * before(1) - t * (s + t) * was * before(2) &
            - t * (s * lambda + t * was) * (before(4) + was * before(3)))
         ! The reactions of supports that move with lambda
         model%external = model%external + 0.5_wp * (lambda - was) * (model%support(1, 2) &
            + lambda * model%support(2, 2) + model%support_was(1, 2) + was * model%support_was(2, 2))
      end if
      model%event%rank = 0
      call model_recorded(model, lambda, status)
      if (counted) model%dissipated = model%dissipated + model%excess
      model%held = held
      model%cross = cross
      model%work = now
      model%support_was = model%support
      model%lambda_recorded = lambda
      model%scale_recorded = s
      model%lambda = lambda
      ! Where joints have slid under the constant loads, energies count from there: their way is not known
      if (model%slides .and. .not. (counted .or. model%carried)) model%external = stored_energy(model)
   end subroutine account

   !> Energy stored in the last state [J]
   pure function stored_energy(model) result(stored)
      type(element_model), intent(in) :: model
      real(wp) :: stored
      stored = 0.5_wp * model%scale**2 * &
         (model%work(1) + model%lambda * (model%work(2) + model%cross + model%lambda * model%work(3)))
      ! u K u / 2 - fo.u and the energy of the origins, with K u = f + fo + fh
      if (model%slides) stored = stored + model%origin_energy - model%excess + 0.5_wp * (model%held(1) + &
         model%lambda * model%held(2) - dot_product(model%fo, model%u_before))
   end function stored_energy

   !> One row of the log
   subroutine record(model, found, equilibrium, first, equation, share, ratio, log)
      type(element_model), intent(inout) :: model
      type(scan_result), intent(in) :: found
      logical, intent(in) :: equilibrium
      integer(c_int), intent(in) :: first(:)
      integer(c_int), intent(in) :: equation(:)
      real(wp), intent(in) :: share(:)
      real(wp), intent(in) :: ratio(:)      !! see watch
      type(event_log), intent(inout) :: log
      real(wp) :: slope
      integer :: k, i, offset

      log%count = log%count + 1
      log%reals(:, log%count) = [model%lambda, found%hi%value, found%lo%value, stored_energy(model), model%external, &
         model%dissipated, model%cracked, model%work(3), model%residual, model%scale, &
         model%support(1, 2) + model%lambda * model%support(2, 2)]
      offset = 0
      if (model%pending(1) /= 0) then
         select type (group => model%holders(model%pending(1))%group)
         class is (point_group)
            offset = group%offset
         end select
      end if
      log%integers(:, log%count) = [int(offset + model%pending(2), c_int), int(model%pending(3), c_int), &
         int(model%events, c_int), merge(1_c_int, 0_c_int, equilibrium)]
      do k = 1, size(log%monitors, 1)
         if (abs(ratio(k)) > 0.0_wp) then
            slope = ratio(k) * (model%work(3) - model%support(2, 2))
            log%monitors(k, log%count) = ratio(k) * (model%cross - model%support(2, 1)) + model%lambda * slope
         else
            log%monitors(k, log%count) = 0.0_wp
            slope = 0.0_wp
            do i = int(first(k)), int(first(k + 1)) - 1
               log%monitors(k, log%count) = log%monitors(k, log%count) + &
                  share(i) * (model%ua(equation(i)) + model%lambda * model%ub(equation(i)))
               slope = slope + share(i) * model%ub(equation(i))
            end do
         end if
         log%monitors(k, log%count) = model%scale * log%monitors(k, log%count)
         if (k == 1) model%slope = slope
      end do
      if (.not. model%releasing) return
      log%reals([4, log_reals], log%count) = model%free
      do k = 1, size(log%monitors, 1)
         log%monitors(k, log%count) = 0.0_wp
         do i = int(first(k)), int(first(k + 1)) - 1
            associate (q => equation(i))
               log%monitors(k, log%count) = log%monitors(k, log%count) + share(i) * (model%from(q) + &
                  model%released * (model%ua(q) + model%lambda * model%ub(q) - model%from(q)))
            end associate
         end do
      end do
   end subroutine record

   !> w_i . x over the entries of an event
   pure function component(event, i, x) result(total)
      type(event_vectors), intent(in) :: event
      integer, intent(in) :: i
      real(wp), intent(in) :: x(0:)
      real(wp) :: total
      integer :: k
      total = 0.0_wp
      do k = 1, event%entries
         total = total + event%w(k, i) * x(event%index(k))
      end do
   end function component

   !> w_i . (x + lambda y) over the entries of an event: dot_product would gather them in memory that it does not ask
   !> for
   pure function along(event, i, x, y, lambda) result(total)
      type(event_vectors), intent(in) :: event
      integer, intent(in) :: i
      real(wp), intent(in) :: x(0:)
      real(wp), intent(in) :: y(0:)
      real(wp), intent(in) :: lambda
      real(wp) :: total
      integer :: k
      total = 0.0_wp
      do k = 1, event%entries
         total = total + event%w(k, i) * (x(event%index(k)) + lambda * y(event%index(k)))
      end do
   end function along

end module sla_events
