!> Energies from state to state, and the log of the states.
!>
!> External work is that of the trapezium between successive states, energy is dissipated at the damaged points alone,
!> and what the elements store must close the balance.
module sla_ledger
   use common_kinds, only : wp
   use sla_group, only : along, point_group, scan_result
   use sla_model, only : element_model, held_work, model_reactions, model_recorded
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: account, follow_supports, record, watch, event_log, log_reals, log_integers

   integer, parameter :: log_reals = 11, log_integers = 4

   !> What is recorded; monitors are weighted sums of equations
   type :: event_log
      integer :: count = 0
      !> lambda, upper limit, lower limit, stored, external, lost on the straight way, crack energy [J], compliance
      !> fb.ub (where supports move with lambda their stiffness instead), residual, scale of all loads, force that moves
      !> supports [N]
      real(wp), allocatable :: reals(:, :)         !! (log_reals, room)
      !> point (1-based), code, tooth reached by it before, 1 in equilibrium
      integer(c_int), allocatable :: integers(:, :)  !! (log_integers, room)
      real(wp), allocatable :: monitors(:, :)      !! (monitors, room)
   end type event_log

contains

   !> Energy ledger up to the state lambda: external work by the trapezium between successive states,
   !> dissipation at the damaged points alone; the stored energy must close the balance
   subroutine account(model, lambda, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: lambda
      integer(c_int), intent(out) :: status
      logical :: counted
      real(wp) :: now(3), held(2), after, was, s, t, cross, free(4), before(4), elastic
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
      elastic = model%elastic
      call model_recorded(model, lambda, status)
      if (counted) model%dissipated = model%dissipated + model%excess + elastic - model%elastic
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
      if (model%slides) stored = stored + model%origin_energy - model%excess + model%elastic + 0.5_wp * ( &
         model%held(1) + &
         model%lambda * model%held(2) - dot_product(model%fo, model%u_before))
   end function stored_energy

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
      model%wanted(:) = model%watched
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

end module sla_ledger
