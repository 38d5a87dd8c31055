!> The event loop of sequentially linear analysis under loads A + lambda B (thesis 4.3.1).
!>
!> Each event: apply the last damage (one solve with its vectors, Sherman-Morrison-Woodbury correction of
!> both displacements, rank-one changes of the factor), scan all points for the admissible range of lambda,
!> choose the point that leaves it, record the state. The loop knows groups, not materials.
module sla_events
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : code_stick => sla_event_stick, &
      stop_none => sla_stop_none, stop_mechanism => sla_stop_mechanism, &
      stop_unbounded => sla_stop_unbounded, stop_all_empty => sla_stop_all_empty, &
      stop_displacement => sla_stop_displacement, stop_load => sla_stop_load, stop_fraction => sla_stop_fraction, &
      stop_lost => sla_stop_lost
   use common_status, only : status_ok, status_cancelled, status_not_positive_definite, status_beyond_strength
   use sla_assembly, only : add_event
   use sla_c_bindings, only : extrados_sparse_event, extrados_sparse_rank1, extrados_sparse_solve
   use sla_group, only : below, bound, point_group, scan_result, unbounded, most_entries, most_rank
   use sla_model, only : element_model, model_factor, model_solve, held_work
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: run_events, residual, scan_model, stop_rules, event_log, log_reals, log_integers

   integer, parameter :: log_reals = 9, log_integers = 4
   real(wp), parameter :: least_pivot = 1.0e-10_wp    !! of I - W' inv(K) W: below it the structure is a mechanism
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
   end type stop_rules

   !> What is recorded; monitors are weighted sums of equations
   type :: event_log
      integer :: count = 0
      !> lambda, upper limit, lower limit, stored, external, dissipated, crack energy [J], compliance fb.ub, residual
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
      logical :: equilibrium

      reason = stop_none
      status = status_ok
      log%count = 0
      do while (log%count < size(log%reals, 2))
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
         if (model%pending(1) /= 0) then
            call apply_event(model, reason, status)
            if (status /= status_ok .or. reason /= stop_none) return
         end if
         call scan_model(model, found)
         model%hot(:, 1) = [found%hi%group, found%hi%point]
         model%hot(:, 2) = [found%lo%group, found%lo%point]
         equilibrium = found%empty%point == 0 .and. found%hi%value >= found%lo%value
         if (rules%refuse_overload .and. .not. model%recorded .and. .not. equilibrium) then
            status = status_beyond_strength
            return
         end if
         if (.not. found%bounded) reason = stop_unbounded
         if (equilibrium .and. rules%lambda < unbounded .and. found%hi%value >= rules%lambda .and. &
             found%lo%value <= rules%lambda) then
            reason = stop_load
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
         if (reason == stop_load) then
            model%pending = 0
            call account(model, rules%lambda)
         else if (reason == stop_unbounded) then
            return
         else
            call account(model, model%lambda)
         end if
         call record(model, found, equilibrium, first, equation, share, log)
         if (reason /= stop_none) return
         if (equilibrium) then
            if (model%lambda > model%peak) then
               model%peak = model%lambda
               model%peak_displacement = log%monitors(1, log%count)
            end if
            if (abs(log%monitors(1, log%count)) >= rules%displacement) reason = stop_displacement
            ! A drop on the way back from a small crack is no end: the wall must have gone further than at its peak.
            if (rules%fraction >= 0.0_wp .and. model%peak > 0.0_wp .and. &
                model%lambda < rules%fraction * model%peak .and. &
                (log%monitors(1, log%count) - model%peak_displacement) * model%slope > 0.0_wp) reason = stop_fraction
         end if
         ! Where no multiplier brings a state back, limits run away
         if (model%peak > 0.0_wp .and. .not. equilibrium) then
            if (.not. abs(model%lambda) <= farthest * model%peak) reason = stop_lost
         end if
         ! Friction makes the structure unsymmetric: beyond its limit it may answer the load the other way; but what
         ! slides back sticks at once
         if (.not. abs(model%work(3)) <= rules%compliance * model%first_compliance) then
            if (model%pending(3) /= code_stick) reason = stop_mechanism
         end if
         if (reason /= stop_none) return
      end do
   end subroutine run_events

   !> Limits over all points, the same for any number of threads: pieces are joined in their order
   subroutine scan_model(model, found)
      type(element_model), intent(inout) :: model
      type(scan_result), intent(out) :: found
      type(scan_result) :: guess
      integer :: k

      ! The limits of the point damaged last are near the new ones: loosened, they spare most points the roots.
      call guess_limits(model, guess)
      !$omp parallel do schedule(static) default(none) shared(model, guess) private(k) &
      !$omp num_threads(model%threads) if(model%threads > 1)
      do k = 1, size(model%piece, 2)
         model%part(k) = guess
         select type (group => model%holders(model%piece(1, k))%group)
         class is (point_group)
            call group%scan(model%piece(2, k), model%piece(3, k), model%ua, model%ub, model%lambda, model%noise, &
               model%part(k))
         end select
      end do
      !$omp end parallel do
      found = scan_result()
      do k = 1, size(model%part)
         associate (g => model%piece(1, k))
            found%bounded = found%bounded .or. model%part(k)%bounded
            if (model%part(k)%hi%point /= 0 .and. below(model%part(k)%hi%value, found%hi%value)) then
               found%hi = model%part(k)%hi
               found%hi%group = g
            end if
            if (model%part(k)%lo%point /= 0 .and. below(-model%part(k)%lo%value, -found%lo%value)) then
               found%lo = model%part(k)%lo
               found%lo%group = g
            end if
            if (model%part(k)%empty%point /= 0 .and. &
                (found%empty%point == 0 .or. model%part(k)%empty%value > found%empty%value)) then
               found%empty = model%part(k)%empty
               found%empty%group = g
            end if
         end associate
      end do
   end subroutine scan_model

   !> Loosened limits of the points that set the last ones
   subroutine guess_limits(model, guess)
      type(element_model), intent(in) :: model
      type(scan_result), intent(out) :: guess
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
            if (found%hi%point /= 0) guess%hi%value = min(guess%hi%value, &
               found%hi%value + 1.0e-9_wp * abs(found%hi%value))
            if (found%lo%point /= 0) guess%lo%value = max(guess%lo%value, &
               found%lo%value - 1.0e-9_wp * abs(found%lo%value))
         end select
      end do
   end subroutine guess_limits

   !> The point to damage next and its multiplier
   pure subroutine choose(model, chosen)
      type(element_model), intent(inout) :: model
      type(bound), intent(in) :: chosen
      model%pending = [chosen%group, chosen%point, chosen%code]
      model%lambda = chosen%value
   end subroutine choose

   !> Damage the pending point; the displacements and the factor follow
   subroutine apply_event(model, reason, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: reason
      integer(c_int), intent(out) :: status
      real(wp) :: m(most_rank, most_rank), wa(most_rank), wb(most_rank)
      integer(c_int) :: index0(most_entries)
      integer :: i, j, r, n, tooth

      reason = stop_none
      status = status_ok
      n = model%equations
      select type (group => model%holders(model%pending(1))%group)
      class is (point_group)
         call group%damage(model%pending(2), model%pending(3), model%lambda, model%ua, model%ub, model%event, tooth)
      end select
      model%pending = 0
      model%events = model%events + 1
      associate (event => model%event)
         r = event%rank
         if (r == 0) return
         do i = 1, r
            model%before(i) = dot_product(event%w(1:event%entries, i), model%ua(event%index(1:event%entries)) + &
               model%lambda * model%ub(event%index(1:event%entries))) - event%origin(i)
            model%cracked = model%cracked + 0.5_wp * event%sign(i) * model%before(i)**2
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
         index0 = event%index - 1_c_int
         status = extrados_sparse_event(model%handle, int(r, c_int), int(event%entries, c_int), index0, &
            reshape(event%w(1:event%entries, 1:r), [event%entries * r]), model%z)
         if (status /= status_ok) return
         do j = 1, r
            do i = 1, r
               m(i, j) = -dot_product(event%w(1:event%entries, i), model%z(event%index(1:event%entries), j))
            end do
            m(j, j) = m(j, j) + event%sign(j)
            wa(j) = dot_product(event%w(1:event%entries, j), model%ua(event%index(1:event%entries))) - &
               event%origin(j) - event%hold(1, j)
            model%fo(event%index(1:event%entries)) = model%fo(event%index(1:event%entries)) - &
               event%sign(j) * event%origin(j) * event%w(1:event%entries, j)
            do i = 1, 2
               model%fh(event%index(1:event%entries), i) = model%fh(event%index(1:event%entries), i) - &
                  event%sign(j) * event%hold(i, j) * event%w(1:event%entries, j)
            end do
            wb(j) = dot_product(event%w(1:event%entries, j), model%ub(event%index(1:event%entries))) - event%hold(2, j)
         end do
         call small(m, wa, wb, r, all(event%sign(1:r) > 0.0_wp), reason)
         if (reason /= stop_none) return
         do j = 1, r
            model%ua(1:n) = model%ua(1:n) + wa(j) * model%z(:, j)
            model%ub(1:n) = model%ub(1:n) + wb(j) * model%z(:, j)
         end do
         ! Stiffening first: no way-station is less definite than the ends.
         do j = 1, 2
            do i = 1, r
               if ((event%sign(i) > 0.0_wp) .eqv. (j == 1)) cycle
               status = extrados_sparse_rank1(model%handle, int(-sign(1.0_wp, event%sign(i)), c_int), &
                  int(event%entries, c_int), index0, event%w(1:event%entries, i))
               if (status == status_not_positive_definite) then
                  status = status_ok
                  reason = stop_mechanism
               end if
               if (status /= status_ok .or. reason /= stop_none) return
            end do
         end do
      end associate
      if (mod(model%events, guard_every) == 0) call guard_residual(model, status)
   end subroutine apply_event

   !> Solve m x = wa, m y = wb by elimination without pivoting: m is positive definite for softening events
   pure subroutine small(m, wa, wb, r, definite, reason)
      real(wp), intent(inout) :: m(:, :)
      real(wp), intent(inout) :: wa(:)
      real(wp), intent(inout) :: wb(:)
      integer, intent(in) :: r
      logical, intent(in) :: definite
      integer(c_int), intent(inout) :: reason
      real(wp) :: f
      integer :: i, j
      do j = 1, r
         if ((definite .and. .not. m(j, j) > least_pivot) .or. .not. abs(m(j, j)) > least_pivot) then
            reason = stop_mechanism
            return
         end if
         do i = j + 1, r
            f = m(i, j) / m(j, j)
            m(i, j:r) = m(i, j:r) - f * m(j, j:r)
            wa(i) = wa(i) - f * wa(j)
            wb(i) = wb(i) - f * wb(j)
         end do
      end do
      do j = r, 1, -1
         wa(j) = (wa(j) - dot_product(m(j, j + 1:r), wa(j + 1:r))) / m(j, j)
         wb(j) = (wb(j) - dot_product(m(j, j + 1:r), wb(j + 1:r))) / m(j, j)
      end do
   end subroutine small

   !> Residuals of both displacements by the elements; refine, then factorise anew, only where they ask for it
   subroutine guard_residual(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer(c_int) :: node, direction
      real(wp) :: ratio
      integer :: n

      status = status_ok
      n = model%equations
      model%guard(1) = model%guard(1) + 1
      call residual(model)
      if (model%residual <= most_residual) return
      model%guard(2) = model%guard(2) + 1
      status = extrados_sparse_solve(model%handle, 2_c_int, model%z)
      if (status /= status_ok) return
      model%ua(1:n) = model%ua(1:n) + model%z(:, 1)
      model%ub(1:n) = model%ub(1:n) + model%z(:, 2)
      call residual(model)
      if (model%residual <= most_residual) return
      model%guard(3) = model%guard(3) + 1
      call model_factor(model, node, direction, ratio, status)
      if (status == status_ok) call model_solve(model, status)
      if (status == status_ok) call residual(model)
   end subroutine guard_residual

   !> Residual forces into z, the larger relative norm into made%residual
   subroutine residual(model)
      type(element_model), intent(inout) :: model
      real(wp) :: load
      integer :: k, g, n
      n = model%equations
      model%residual = 0.0_wp
      do k = 1, 2
         model%force = 0.0_wp
         do g = 1, size(model%holders)
            if (k == 1) call model%holders(g)%group%force(model%ua, model%force)
            if (k == 2) call model%holders(g)%group%force(model%ub, model%force)
         end do
         if (k == 1) model%z(:, k) = model%fa(1:n) + model%fo(1:n) + model%fh(1:n, 1) - model%force(1:n)
         if (k == 2) model%z(:, k) = model%fb(1:n) + model%fh(1:n, 2) - model%force(1:n)
         load = merge(norm2(model%fa), norm2(model%fb), k == 1)
         if (load > 0.0_wp) model%residual = max(model%residual, norm2(model%z(:, k)) / load)
      end do
   end subroutine residual

   !> Energy ledger up to the state lambda: external work by the trapezium between successive states,
   !> dissipation at the damaged points alone; the stored energy must close the balance
   subroutine account(model, lambda)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: lambda
      real(wp) :: new(3), held(2), after, was, change, cross
      integer :: i

      was = model%lambda_recorded
      held = held_work(model, lambda)
      cross = dot_product(model%fb, model%ua)   ! fa.ub too, but for friction that slides
      change = 0.0_wp
      new = [dot_product(model%fa, model%ua), dot_product(model%fa, model%ub), dot_product(model%fb, model%ub)]
      if (.not. model%recorded) then
         ! The first state of a stage: the constant loads are on, or were brought on by the stage before.
         if (.not. model%carried) model%external = model%external + 0.5_wp * new(1)
         model%external = model%external + 0.5_wp * lambda * (new(2) + cross) + 0.5_wp * lambda**2 * new(3)
         model%recorded = .true.
      else
         associate (event => model%event)
            do i = 1, event%rank
               after = dot_product(event%w(1:event%entries, i), model%ua(event%index(1:event%entries)) + &
                  lambda * model%ub(event%index(1:event%entries))) - event%origin(i)
               model%dissipated = model%dissipated + 0.5_wp * event%sign(i) * (model%before(i) * after - &
                  event%origin(i)**2)
               ! What the change of the held forces did at the old and at the new displacements
               change = change + event%sign(i) * ( &
                  (event%hold(1, i) + was * event%hold(2, i)) * (after + event%origin(i)) &
                  + (event%hold(1, i) + lambda * event%hold(2, i)) * (model%before(i) + event%origin(i)))
            end do
            model%dissipated = model%dissipated - event%shift
         end associate
         ! Work of the held forces, (fh_old + fh_new) . (u_new - u_old) / 2
         model%dissipated = model%dissipated - 0.5_wp * (2.0_wp * held(1) + (lambda + was) * held(2) &
            - 2.0_wp * model%held(1) - (lambda + was) * model%held(2) + change)
         ! (f_old + f_new) . (u_new - u_old) / 2 with f = A + lambda B, u = ua + lambda ub
         model%external = model%external + 0.5_wp * ( &
            2.0_wp * new(1) + 2.0_wp * lambda * new(2) + (was + lambda) * cross + (was * lambda + lambda**2) * new(3) &
            - 2.0_wp * model%work(1) - 2.0_wp * was * model%work(2) - (lambda + was) * model%cross &
            - (was * lambda + was**2) * model%work(3))
      end if
      model%event%rank = 0
      model%held = held
      model%cross = cross
      model%work = new
      model%lambda_recorded = lambda
      model%lambda = lambda
   end subroutine account

   !> One row of the log
   subroutine record(model, found, equilibrium, first, equation, share, log)
      type(element_model), intent(inout) :: model
      type(scan_result), intent(in) :: found
      logical, intent(in) :: equilibrium
      integer(c_int), intent(in) :: first(:)
      integer(c_int), intent(in) :: equation(:)
      real(wp), intent(in) :: share(:)
      type(event_log), intent(inout) :: log
      real(wp) :: stored
      integer :: k, i, offset

      log%count = log%count + 1
      stored = 0.5_wp * (model%work(1) + model%lambda * (model%work(2) + model%cross + model%lambda * model%work(3)))
      ! u K u / 2 - fo.u and the energy of the origins, with K u = f + fo + fh
      stored = stored + model%origin_energy + 0.5_wp * (model%held(1) + model%lambda * model%held(2) &
         - dot_product(model%fo, model%ua + model%lambda * model%ub))
      log%reals(:, log%count) = [model%lambda, found%hi%value, found%lo%value, stored, model%external, &
         model%dissipated, model%cracked, model%work(3), model%residual]
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
         log%monitors(k, log%count) = 0.0_wp
         do i = int(first(k)), int(first(k + 1)) - 1
            log%monitors(k, log%count) = log%monitors(k, log%count) + &
               share(i) * (model%ua(equation(i)) + model%lambda * model%ub(equation(i)))
            if (k == 1) model%slope = merge(0.0_wp, model%slope, i == first(1)) + share(i) * model%ub(equation(i))
         end do
      end do
   end subroutine record

end module sla_events
