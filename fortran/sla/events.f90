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
   use sla_friction, only : find_sliders
   use sla_group, only : bound, component, most_entries, most_rank, point_group, scan_result, slider, unbounded
   use sla_guard, only : guard_every, guard_residual
   use sla_ledger, only : account, event_log, follow_supports, log_reals, record, watch
   use sla_model, only : element_model, model_balance, model_follow, model_settled, model_slips, model_solve, &
      model_turns
   use sla_regions, only : regions_bring, regions_home
   use sla_release, only : hold_state, set_free
   use sla_scan, only : bring_all, choose, crossed, scan_model, scan_scaled
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: run_events, stop_rules

   real(wp), parameter :: least_pivot = 1.0e-10_wp    !! of I - W' inv(K) W: below it the structure is a mechanism
   !> Multiplier of an event without equilibrium over the peak before, from which no state is sought any more
   real(wp), parameter :: farthest = 1.0e3_wp
   !> Of the way to the peak: so much further the load must stay below a fraction of the peak to have fallen below it
   real(wp), parameter :: further = 0.1_wp

   !> What happens to a joint without a force beside its stiffness
   integer(c_int), parameter :: in_place(3) = [code_tension, code_compression, code_open]

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
      real(wp) :: far = unbounded                  !! way of monitor 1 beyond which displacements are not small [m]
   end type stop_rules

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
      logical :: equilibrium, driven, met, turned, first_of_stage, fallen
      integer :: info

      driven = any(abs(model%moved(:, 2)) > 0.0_wp)
      turned = .false.
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
            call change_state(model, rules%compliance, driven, turned, reason, status)
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
         first_of_stage = .not. model%recorded
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
            ! Force release holds the load: what has its lower limit above it (a crack that closes, a point that touches
            ! its strength) is damaged at the load reached
            if (rules%release .and. model%recorded) found%lo%value = model%lambda
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
         if (first_of_stage) model%start_displacement = log%monitors(1, log%count) - model%lambda * model%slope
         if (equilibrium) then
            model%lambda_held = model%lambda
            reached = merge(log%reals(log_reals, log%count), model%lambda + rules%already, driven)
            if (abs(log%monitors(1, log%count) - model%start_displacement) > rules%far) reason = stop_far
            if (reached > model%peak .and. reason == stop_none) then
               model%peak = reached
               model%peak_displacement = log%monitors(1, log%count)
            end if
            if (abs(log%monitors(1, log%count)) >= rules%displacement) reason = stop_displacement
            if (reason == stop_none) then
               call judge_fall(model, rules, reached, log%monitors(1, log%count), fallen)
               if (fallen) reason = stop_fraction
            end if
         end if
         ! Where no multiplier brings a state back, limits run away
         if (model%peak > 0.0_wp .and. .not. equilibrium) then
            reached = merge(abs(model%lambda_held), model%peak, driven)
            if (.not. abs(model%lambda) <= farthest * reached) reason = stop_lost
         end if
         ! Joints that slide make the structure unsymmetric: it may answer the load the other way, until what slides
         ! back sticks, at once. Where all were asked there is no such way.
         if (too_soft(model, driven, rules%compliance)) then
            if (turned .or. model%pending(3) /= code_stick) reason = stop_mechanism   ! whatever it says besides
         end if
         if (reason /= stop_none) return
      end do
   end subroutine run_events

   !> Does the envelope of load over displacement stay below a fraction of its peak, over a tenth of the way to it? So
   !> do all states from the first one below it that is the furthest so far; a single tooth gives one such state
   subroutine judge_fall(model, rules, reached, displacement, fallen)
      type(element_model), intent(inout) :: model
      type(stop_rules), intent(in) :: rules
      real(wp), intent(in) :: reached          !! load, or its multiplier
      real(wp), intent(in) :: displacement     !! of monitor 1 [m]
      logical, intent(out) :: fallen
      real(wp) :: way
      fallen = .false.
      if (rules%fraction < 0.0_wp .or. .not. model%peak > 0.0_wp) return
      way = sign(1.0_wp, model%slope) * (displacement - model%start_displacement)
      if (reached >= rules%fraction * model%peak) then
         model%fallen_from = unbounded
      else if (model%fallen_from < unbounded) then
         fallen = way >= model%fallen_from + further * abs(model%peak_displacement - model%start_displacement)
      else if (way > model%furthest) then
         model%fallen_from = way
      end if
      model%furthest = max(model%furthest, way)
   end subroutine judge_fall

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

   !> The pending event; where friction then leads in a circle or nowhere, all points at its limit turn at once
   subroutine change_state(model, softest, driven, turned, reason, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: softest           !! see too_soft
      logical, intent(in) :: driven
      logical, intent(out) :: turned            !! which points slide and which stick was asked of all of them
      integer(c_int), intent(out) :: reason
      integer(c_int), intent(out) :: status
      type(slider), allocatable :: point(:)
      real(wp), allocatable :: ua(:), ub(:), fh(:, :)
      integer, allocatable :: turn(:, :)
      integer :: i, place(2), info
      logical :: circle, nowhere, found
      turned = .false.
      place = model%pending(1:2)
      circle = .false.
      select type (group => model%holders(place(1))%group)
      class is (point_group)
         circle = group%undecided(place(2), model%pending(3), model%lambda)
         if (group%slides .and. .not. model%slides .and. all(model%pending(3) /= in_place)) then
            call bring_all(model, status)
            if (status == status_ok) call model_slips(model, status)
            if (status /= status_ok) return
         end if
      end select
      call apply_event(model, reason, status)
      if (.not. model%slides .or. status /= status_ok .or. reason /= stop_none) return
      call bring_all(model, status)
      if (status == status_ok) call find_sliders(model%holders, point, status)
      if (status /= status_ok) return
      allocate (ua, source=model%ua, stat=info)
      if (info == 0) allocate (ub, source=model%ub, stat=info)
      if (info == 0) allocate (fh, source=model%fh, stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      ! Also where all are asked: a point beyond its limit has some way to go at this load, before any rate counts
      call slide(model, reason, status)
      if (status /= status_ok) return
      nowhere = reason /= stop_none
      if (driven) then
         nowhere = nowhere .or. too_soft(model, driven, softest)
      else
         nowhere = nowhere .or. .not. abs(model%work_now(3)) <= softest * model%first_compliance
      end if
      if (.not. (nowhere .or. circle)) return
      if (nowhere) then
         ! Back to where they had not moved yet, whose numbers have more digits
         model%ua(:) = ua
         model%ub(:) = ub
         model%fh(:, :) = fh
         do i = 1, size(point)
            select type (group => model%holders(point(i)%group)%group)
            class is (point_group)
               call group%hold(point(i)%point, point(i)%held)
            end select
         end do
         call model_settled(model)
      end if
      turned = .true.
      call model_turns(model, turn, found, status)
      if (status /= status_ok) return
      reason = merge(stop_none, stop_mechanism, found)
      if (found) then
         do i = 1, size(turn, 2)
            call account(model, model%lambda, status)
            if (status /= status_ok) return
            model%pending = turn(:, i)
            call apply_event(model, reason, status)
            if (status /= status_ok .or. reason /= stop_none) return
            call model_follow(model, status)
            if (status == status_ok) call bring_all(model, status)
            if (status /= status_ok) return
         end do
      end if
      if (found) call slide(model, reason, status)
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
         ! Flexibilities that have not followed the event before this one are lost
         model%friction%known = model%friction%known .and. model%friction%current
         model%friction%current = .false.
         model%cracked = model%cracked + model%scale**2 * event%crack
         n = event%entries
         do i = 1, event%rank
            before(:, i) = [component(event, i, model%ua), component(event, i, model%ub)]
            model%before(i) = model%scale * (before(1, i) + model%lambda * before(2, i)) - event%origin(i)
            if (model%releasing) then
               model%before(i) = component(event, i, model%from)
               model%dissipated = model%dissipated + 0.5_wp * event%sign(i) * model%before(i)**2
            end if
            if (event%cracks .and. event%sign(i) > 0.0_wp) model%cracked = model%cracked + 0.5_wp * model%before(i)**2
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
         do i = 1, merge(0, event%rank, model%slides)   ! sliding friction lets the loads do other work, see account
            after = [component(event, i, model%ua), component(event, i, model%ub)]
            model%work_now = model%work_now + event%sign(i) * &
               [before(1, i) * after(1), before(1, i) * after(2), before(2, i) * after(2)]
         end do
      end associate
      if (mod(model%events, guard_every) == 0) call guard_residual(model, status)
   end subroutine apply_event

   !> What slides balances with what changed, and has come as far as it is
   subroutine slide(model, reason, status)
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
      do g = 1, size(model%holders)
         select type (group => model%holders(g)%group)
         class is (point_group)
            call group%advance(model%lambda, model%ua, model%ub)
         end select
      end do
   end subroutine slide

end module sla_events
