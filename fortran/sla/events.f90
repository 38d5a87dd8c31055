!> The event loop of sequentially linear analysis under loads A + lambda B (thesis 4.3.1).
!>
!> Each event: apply the last damage (change the factor along the path of its element, bring the displacements up to
!> date there), look for the admissible range of lambda wherever it can have changed enough (sla_scan), choose
!> the point that leaves it, record the state (sla_ledger). The loop knows groups, not materials: see sla_group for
!> what an element must give it.
module sla_events
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : code_stick => sla_event_stick, code_tension => sla_event_tension, &
      code_compression => sla_event_compression, code_open => sla_event_open, &
      stop_none => sla_stop_none, stop_mechanism => sla_stop_mechanism, &
      stop_unbounded => sla_stop_unbounded, stop_all_empty => sla_stop_all_empty, &
      stop_displacement => sla_stop_displacement, stop_load => sla_stop_load, stop_fraction => sla_stop_fraction, &
      stop_lost => sla_stop_lost, stop_far => sla_stop_far
   use common_status, only : status_ok, status_cancelled, status_out_of_memory, status_not_positive_definite, &
      status_beyond_strength
   use sla_assembly, only : add_event
   use sla_c_bindings, only : extrados_sparse_change
   use sla_continuation, only : begin_path, model_continues
   use sla_friction, only : find_sliders
   use sla_group, only : bound, component, friction_group, most_entries, most_rank, point_event, point_group, &
      point_place, scan_result, slider, unbounded
   use sla_guard, only : guard_every, guard_residual
   use sla_ledger, only : account_state, event_log, follow_supports, judge_fall, log_reals, record_state, watch_monitors
   use sla_model, only : element_model, model_balance, model_follow, model_settled, model_slips, model_solve, &
      model_turns
   use sla_regions, only : regions_bring, regions_home
   use sla_state, only : load_work, monitor_set
   use sla_release, only : hold_state, set_free
   use sla_scan, only : bring_all, choose_event, crossed, scan_model, scan_scaled
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: run_events

   real(wp), parameter :: least_pivot = 1.0e-10_wp    !! of I - W' inv(K) W: below it the structure is a mechanism
   !> Multiplier of an event without equilibrium over the peak before, from which no state is sought any more
   real(wp), parameter :: farthest = 1.0e3_wp

   !> What happens to a joint without a force beside its stiffness
   integer(c_int), parameter :: in_place(3) = [code_tension, code_compression, code_open]

contains

   !> Run up to `room` events and record them; the last one is chosen but not applied yet
   subroutine run_events(model, monitors, log, reason, status)
      type(element_model), intent(inout) :: model
      type(monitor_set), intent(inout) :: monitors
      type(event_log), intent(inout) :: log
      integer(c_int), intent(out) :: reason       !! of the list sla_stop
      integer(c_int), intent(out) :: status       !! status_cancelled leaves a valid log
      type(scan_result) :: found
      type(bound) :: scaled
      real(wp) :: reached, at
      logical :: equilibrium, driven, met, turned, first_of_stage, fallen

      driven = any(abs(model%support%moved(:, 2)) > 0.0_wp)
      turned = .false.
      at = 0.0_wp
      reason = stop_none
      log%count = 0
      status = status_ok
      call watch_monitors(model, monitors)
      do while (log%count < size(log%reals, 2))
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
         if (model%rules%release .and. model%loop%pending%group /= 0) call hold_state(model, status)
         if (status /= status_ok) return
         if (model%loop%pending%group /= 0) then
            call change_state(model, driven, turned, reason, status)
            if (status == status_ok .and. reason == stop_mechanism) call hand_over(model, reason, status)
            if (status /= status_ok .or. reason /= stop_none .or. model%path%active) return
         end if
         if (model%release%active) then
            call set_free(model, found, status)
            if (status /= status_ok) return
            call record_state(model, found, .not. model%release%active, monitors, log)
            if (too_soft(model, driven)) reason = stop_mechanism
            if (reason /= stop_none) return
            cycle
         end if
         call scan_model(model, found, status)
         if (status /= status_ok) return
         if (size(model%support%moved, 1) > 0) call follow_supports(model)
         model%search%upper = point_place(found%hi%group, found%hi%point)
         model%search%lower = point_place(found%lo%group, found%lo%point)
         equilibrium = found%empty%point == 0 .and. .not. crossed(found)
         first_of_stage = .not. model%ledger%recorded
         if (model%rules%refuse_overload .and. .not. model%ledger%recorded .and. .not. equilibrium) then
            status = status_beyond_strength
            return
         end if
         if (model%ledger%recorded .and. .not. equilibrium) then
            reason = stop_lost
            call hand_over(model, reason, status)
            if (status /= status_ok .or. model%path%active) return
            reason = stop_none
         end if
         if (.not. found%bounded) reason = stop_unbounded
         model%loop%scale = 1.0_wp
         scaled = bound()
         if (model%rules%proportional .and. .not. equilibrium .and. found%bounded) then
            call scan_scaled(model, scaled, status)
         end if
         if (status /= status_ok) return
         call meet_target(model, found, monitors, at, met)
         if (equilibrium .and. model%rules%lambda < unbounded .and. found%hi%value >= model%rules%lambda .and. &
             found%lo%value <= model%rules%lambda) then
            reason = stop_load
         else if (equilibrium .and. met) then
            reason = stop_displacement
         else if (scaled%point /= 0) then
            model%loop%scale = scaled%value
            scaled%value = model%loop%lambda_held
            call choose_event(model, scaled)
         else if (found%empty%point /= 0) then
            found%empty%value = model%loop%lambda
            if (found%hi%point == 0 .and. found%lo%point == 0) reason = stop_all_empty
            call choose_event(model, found%empty)
         else if (equilibrium .and. found%hi%value < unbounded) then
            call choose_event(model, found%hi)
         else if (found%lo%value > -unbounded .and. .not. equilibrium) then
            ! Force release holds the load: what has its lower limit above it (a crack that closes, a point that touches
            ! its strength) is damaged at the load reached
            if (model%rules%release .and. model%ledger%recorded) found%lo%value = model%loop%lambda
            call choose_event(model, found%lo)
         else
            reason = stop_unbounded    ! only lower limits: the load can grow for ever
         end if
         if (reason == stop_load .or. reason == stop_displacement) then
            model%loop%pending = point_event()
            call account_state(model, merge(model%rules%lambda, at, reason == stop_load), status)
         else if (reason == stop_unbounded) then
            return
         else
            call account_state(model, model%loop%lambda, status)
         end if
         if (status /= status_ok) return
         call record_state(model, found, equilibrium, monitors, log)
         if (reason /= stop_none) return
         if (first_of_stage) model%loop%start_displacement = log%monitors(1, log%count) - &
            model%loop%lambda * model%loop%slope
         if (equilibrium) then
            model%loop%lambda_held = model%loop%lambda
            reached = merge(log%reals(log_reals, log%count), model%loop%lambda + model%rules%already, driven)
            if (abs(log%monitors(1, log%count) - model%loop%start_displacement) > model%rules%far) reason = stop_far
            if (reached > model%loop%peak .and. reason == stop_none) then
               model%loop%peak = reached
               model%loop%peak_displacement = log%monitors(1, log%count)
            end if
            if (abs(log%monitors(1, log%count)) >= model%rules%displacement) reason = stop_displacement
            if (reason == stop_none) then
               call judge_fall(model, reached, log%monitors(1, log%count), fallen)
               if (fallen) reason = stop_fraction
            end if
         end if
         ! Where no multiplier brings a state back, limits run away
         if (model%loop%peak > 0.0_wp .and. .not. equilibrium) then
            reached = merge(abs(model%loop%lambda_held), model%loop%peak, driven)
            if (.not. abs(model%loop%lambda) <= farthest * reached) reason = stop_lost
         end if
         ! Joints that slide make the structure unsymmetric: it may answer the load the other way, until what slides
         ! back sticks, at once. Where all were asked there is no such way.
         if (too_soft(model, driven)) then
            if (turned .or. model%loop%pending%code /= code_stick) reason = stop_mechanism   ! whatever it says besides
         end if
         if (reason == stop_mechanism) call hand_over(model, reason, status)
         if (status /= status_ok .or. model%path%active) return
         if (reason /= stop_none) return
      end do
   end subroutine run_events

   !> Equilibrium iterations go on from here, where the rules want them and all groups can
   subroutine hand_over(model, reason, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(inout) :: reason     !! for which the events end; none where they are gone on with
      integer(c_int), intent(out) :: status
      status = status_ok
      if (.not. model%rules%continues) return
      if (.not. model_continues(model)) return
      call begin_path(model, status)
      reason = stop_none
   end subroutine hand_over

   !> Has the compliance to the growing load grown by a ratio; supports that move also move what has no stiffness left,
   !> unless the constant loads carry it away
   pure function too_soft(model, driven) result(yes)
      type(element_model), intent(in) :: model
      logical, intent(in) :: driven
      logical :: yes
      associate (loop => model%loop, ratio => model%rules%compliance, work => model%solution%work)
         if (driven) then
            yes = loop%first_constant > 0.0_wp .and. .not. work%aa <= ratio * loop%first_constant
         else
            yes = .not. abs(merge(work%bb, model%ledger%work%bb, model%release%active)) <= &
               ratio * loop%first_compliance
         end if
      end associate
   end function too_soft

   !> The multiplier at which monitor 1 has its target, where all points admit it
   pure subroutine meet_target(model, found, monitors, lambda, met)
      type(element_model), intent(in) :: model
      type(scan_result), intent(in) :: found
      type(monitor_set), intent(in) :: monitors
      real(wp), intent(out) :: lambda
      logical, intent(out) :: met
      real(wp) :: start, slope
      met = .false.
      lambda = 0.0_wp
      if (.not. abs(model%rules%side) > 0.0_wp) return
      associate (ratio => monitors%ratio(1), work => model%solution%work, support => model%support%work)
         if (abs(ratio) > 0.0_wp .and. .not. model%sliding%active) then
            start = ratio * (work%ab - support%ba)
            slope = ratio * (work%bb - support%bb)
         else
            start = monitors%sum_of(1, model%solution%ua)
            slope = monitors%sum_of(1, model%solution%ub)
         end if
      end associate
      if (.not. model%rules%side * slope > 0.0_wp) return
      lambda = (model%rules%target - start) / slope
      met = found%empty%point == 0 .and. lambda >= found%lo%value .and. lambda <= found%hi%value
   end subroutine meet_target

   !> The pending event; where friction then leads in a circle or nowhere, all points at its limit turn at once
   subroutine change_state(model, driven, turned, reason, status)
      type(element_model), intent(inout) :: model
      logical, intent(in) :: driven
      logical, intent(out) :: turned            !! which points slide and which stick was asked of all of them
      integer(c_int), intent(out) :: reason
      integer(c_int), intent(out) :: status
      type(slider), allocatable :: point(:)
      real(wp), allocatable :: ua(:), ub(:), fh(:, :)
      type(point_event), allocatable :: turn(:)
      type(point_event) :: pending
      integer :: i, info
      logical :: circle, nowhere, found
      turned = .false.
      pending = model%loop%pending
      circle = .false.
      select type (group => model%mesh%holders(pending%group)%group)
      class is (friction_group)
         circle = group%undecided(pending%point, pending%code, model%loop%lambda)
         if (group%slides .and. .not. model%sliding%active .and. all(pending%code /= in_place)) then
            call bring_all(model, status)
            if (status == status_ok) call model_slips(model, status)
            if (status /= status_ok) return
         end if
      end select
      call apply_event(model, reason, status)
      if (.not. model%sliding%active .or. status /= status_ok .or. reason /= stop_none) return
      call bring_all(model, status)
      if (status == status_ok) call find_sliders(model%mesh%holders, point, status)
      if (status /= status_ok) return
      allocate (ua, source=model%solution%ua, stat=info)
      if (info == 0) allocate (ub, source=model%solution%ub, stat=info)
      if (info == 0) allocate (fh, source=model%load%fh, stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      ! Also where all are asked: a point beyond its limit has some way to go at this load, before any rate counts
      call balance_sliders(model, reason, status)
      if (status /= status_ok) return
      nowhere = reason /= stop_none
      if (driven) then
         nowhere = nowhere .or. too_soft(model, driven)
      else
         nowhere = nowhere .or. &
            .not. abs(model%solution%work%bb) <= model%rules%compliance * model%loop%first_compliance
      end if
      if (.not. (nowhere .or. circle)) return
      if (nowhere) then
         ! Back to where they had not moved yet, whose numbers have more digits
         model%solution%ua(:) = ua
         model%solution%ub(:) = ub
         model%load%fh(:, :) = fh
         do i = 1, size(point)
            select type (group => model%mesh%holders(point(i)%group)%group)
            class is (friction_group)
               call group%set_held(point(i)%point, point(i)%held)
            end select
         end do
         call model_settled(model)
      end if
      turned = .true.
      call model_turns(model, turn, found, status)
      if (status /= status_ok) return
      reason = merge(stop_none, stop_mechanism, found)
      if (found) then
         do i = 1, size(turn)
            call account_state(model, model%loop%lambda, status)
            if (status /= status_ok) return
            model%loop%pending = turn(i)
            call apply_event(model, reason, status)
            if (status /= status_ok .or. reason /= stop_none) return
            call model_follow(model, status)
            if (status == status_ok) call bring_all(model, status)
            if (status /= status_ok) return
         end do
      end if
      if (found) call balance_sliders(model, reason, status)
   end subroutine change_state

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
      associate (loop => model%loop, event => model%loop%event, tree => model%search%tree, ledger => model%ledger, &
         load => model%load, release => model%release, ua => model%solution%ua, ub => model%solution%ub, &
         z => model%solution%z)
         select type (group => model%mesh%holders(loop%pending%group)%group)
         class is (point_group)
            if (release%active) then
               call group%damage(loop%pending%point, loop%pending%code, 0.0_wp, release%from, ub, event, tooth)
            else
               call group%damage(loop%pending%point, loop%pending%code, loop%lambda, ua, ub, event, tooth)
            end if
         end select
         loop%pending = point_event()
         loop%events = loop%events + 1
         tree%now = tree%now + 1
         if (event%rank == 0) return
         ! Flexibilities that have not followed the event before this one are lost
         model%friction%known = model%friction%known .and. model%friction%current
         model%friction%current = .false.
         ledger%cracked = ledger%cracked + loop%scale**2 * event%crack
         n = event%entries
         do i = 1, event%rank
            before(:, i) = [component(event, i, ua), component(event, i, ub)]
            loop%before(i) = loop%scale * (before(1, i) + loop%lambda * before(2, i)) - event%origin(i)
            if (release%active) then
               loop%before(i) = component(event, i, release%from)
               ledger%dissipated = ledger%dissipated + 0.5_wp * event%sign(i) * loop%before(i)**2
            end if
            if (event%cracks .and. event%sign(i) > 0.0_wp) ledger%cracked = ledger%cracked + 0.5_wp * loop%before(i)**2
         end do
         if (model%stiffness%refactor) then
            call add_event(event, model%stiffness%start, model%stiffness%row, model%stiffness%value)
            call model_solve(model, status)
            if (status == status_not_positive_definite) then
               status = status_ok
               reason = stop_mechanism
            end if
            return
         end if
         model%sliding%origin_energy = model%sliding%origin_energy + event%shift
         f = 0
         do i = 1, n
            if (event%index(i) > model%mesh%equations) cycle     ! of a support that moves
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
                     load%fo(to) = load%fo(to) - event%sign(i) * event%origin(i) * w_k
                     load%fh(to, :) = load%fh(to, :) - event%sign(i) * event%hold(:, i) * w_k
                  end associate
               end do
            end do
         end do
         if (f > 0) then
            path = 0
            k = regions_home(tree, event%index(1:n))
            do while (k > 0)
               path = path + 1
               model%search%list(path) = k
               z(tree%part(k)%first:tree%part(k)%last, :) = 0.0_wp   ! part of a region may lie off the path
               k = tree%part(k)%parent
            end do
            index0(1:f) = event%index(unknown(1:f)) - 1_c_int
            status = extrados_sparse_change(model%stiffness%factor, int(changes, c_int), sense, int(f, c_int), index0, &
               w, 2_c_int, b, z, least)
            if (status == status_not_positive_definite .or. (status == status_ok .and. least < least_pivot)) then
               status = status_ok
               reason = stop_mechanism
            end if
            if (status /= status_ok .or. reason /= stop_none) return
            ! From the root down to the element
            do i = path, 1, -1
               call regions_bring(tree, model%search%list(i), model%stiffness%factor, .true., ua, ub, z, status)
               if (status /= status_ok) return
            end do
         end if
         ! Sliding friction lets the loads do other work, see account_state
         do i = 1, merge(0, event%rank, model%sliding%active)
            after = [component(event, i, ua), component(event, i, ub)]
            associate (work => model%solution%work, s => event%sign(i))
               work = load_work(work%aa + s * (before(1, i) * after(1)), work%ab + s * (before(1, i) * after(2)), &
                  work%ba + s * (before(1, i) * after(2)), work%bb + s * (before(2, i) * after(2)))
            end associate
         end do
      end associate
      if (mod(model%loop%events, guard_every) == 0) call guard_residual(model, status)
   end subroutine apply_event

   !> What slides balances with what changed, and has come as far as it is
   subroutine balance_sliders(model, reason, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(inout) :: reason
      integer(c_int), intent(out) :: status
      integer :: g
      call bring_all(model, status)
      if (status /= status_ok) return
      call model_balance(model, status)
      if (status == status_not_positive_definite) then
         status = status_ok
         reason = stop_mechanism
      end if
      if (reason /= stop_none) return
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (friction_group)
            call group%advance(model%loop%lambda, model%solution%ua, model%solution%ub)
         end select
      end do
   end subroutine balance_sliders

end module sla_events
