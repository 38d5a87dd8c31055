!> Energies from state to state, and the log of the states.
!>
!> External work is that of the trapezium between successive states, energy is dissipated at the damaged points alone,
!> and what the elements store must close the balance.
module sla_ledger
   use common_kinds, only : wp
   use sla_group, only : along, point_group, scan_result, unbounded
   use sla_model, only : element_model, held_work, load_products, model_reactions, model_recorded
   use sla_state, only : load_work, monitor_set
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: account_state, follow_supports, record_state, watch_monitors, judge_fall
   public :: event_log, log_reals, log_integers

   integer, parameter :: log_reals = 11, log_integers = 4
   !> Of the way to the peak: so much further the load must stay below a fraction of the peak to have fallen below it
   real(wp), parameter :: further = 0.1_wp

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
   subroutine account_state(model, lambda, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: lambda
      integer(c_int), intent(out) :: status
      logical :: counted
      type(load_work) :: now, free, before
      real(wp) :: held(2), after, was, s, t, elastic
      integer :: i

      associate (ledger => model%ledger, sliding => model%sliding, support => model%support%work, &
         ua => model%solution%ua, ub => model%solution%ub, fh => model%load%fh)
         was = ledger%lambda
         s = model%loop%scale
         t = ledger%scale
         held = 0.0_wp
         now = model%solution%work
         if (sliding%active) then
            held = held_work(model, lambda)
            now = load_products(model)
         end if
         counted = ledger%recorded
         if (.not. counted) then
            ! The first state of a stage: the constant loads are on, or were brought on by the stage before.
            ! From there on A does the work lambda fa.ub, also beside the forces of friction, where fb.ua is another.
            if (ledger%carried) ledger%external = ledger%external - 0.5_wp * now%aa
            ledger%external = ledger%external + 0.5_wp * s**2 * (now%aa + lambda * (now%ab + &
               merge(now%ab, now%ba, ledger%carried) + lambda * now%bb))
            ledger%recorded = .true.
         else
            associate (event => model%loop%event)
               do i = 1, event%rank
                  after = s * along(event, i, ua, ub, lambda) - event%origin(i)
                  ledger%dissipated = ledger%dissipated + 0.5_wp * event%sign(i) * (model%loop%before(i) * after - &
                     event%origin(i)**2)
               end do
               ledger%dissipated = ledger%dissipated - event%shift
            end associate
            ! Work of the held forces, (fh_old + fh_new) . (u_new - u_old) / 2
            if (sliding%active) ledger%dissipated = ledger%dissipated - sliding%excess - 0.5_wp * dot_product( &
               fh(:, 1) + lambda * fh(:, 2) + sliding%f_before, ua + lambda * ub - sliding%u_before)
            ! (f_old + f_new) . (u_new - u_old) / 2 with f = s (A + lambda B), u = s (ua + lambda ub); the loads alone
            free = now - support
            before = ledger%work - ledger%support_work
            ledger%external = ledger%external + 0.5_wp * ( &
               s * (s + t) * free%aa + s * (s + t) * lambda * free%ab &
               + s * (s * lambda + t * was) * (free%ba + lambda * free%bb) &
               - t * (s + t) * before%aa - t * (s + t) * was * before%ab &
               - t * (s * lambda + t * was) * (before%ba + was * before%bb))
            ! The reactions of supports that move with lambda
            ledger%external = ledger%external + 0.5_wp * (lambda - was) * (support%ab + lambda * support%bb + &
               ledger%support_work%ab + was * ledger%support_work%bb)
         end if
         model%loop%event%rank = 0
         elastic = sliding%elastic
         call model_recorded(model, lambda, status)
         if (counted) ledger%dissipated = ledger%dissipated + sliding%excess + elastic - sliding%elastic
         sliding%held = held
         ledger%work = now
         ledger%support_work = support
         ledger%lambda = lambda
         ledger%scale = s
         model%loop%lambda = lambda
         ! Where joints have slid under the constant loads, energies count from there: their way is not known
         if (sliding%active .and. .not. (counted .or. ledger%carried)) ledger%external = stored_energy(model)
      end associate
   end subroutine account_state

   !> Energy stored in the last state [J]
   pure function stored_energy(model) result(stored)
      type(element_model), intent(in) :: model
      real(wp) :: stored
      associate (work => model%ledger%work, lambda => model%loop%lambda, sliding => model%sliding)
         stored = 0.5_wp * model%loop%scale**2 * (work%aa + lambda * (work%ab + work%ba + lambda * work%bb))
         ! u K u / 2 - fo.u and the energy of the origins, with K u = f + fo + fh
         if (sliding%active) stored = stored + sliding%origin_energy - sliding%excess + sliding%elastic + 0.5_wp * ( &
            sliding%held(1) + lambda * sliding%held(2) - dot_product(model%load%fo, sliding%u_before))
      end associate
   end function stored_energy

   !> The forces of moved supports and their part in the work after an event
   subroutine follow_supports(model)
      type(element_model), intent(inout) :: model
      type(load_work) :: was, change
      was = model%support%work
      call model_reactions(model)
      change = model%support%work - was
      associate (work => model%solution%work)
         work = load_work(work%aa + 2.0_wp * change%aa, work%ab + (change%ab + change%ba), &
            work%ba + (change%ab + change%ba), work%bb + 2.0_wp * change%bb)
      end associate
   end subroutine follow_supports

   !> One row of the log
   subroutine record_state(model, found, equilibrium, monitors, log)
      type(element_model), intent(inout) :: model
      type(scan_result), intent(in) :: found
      logical, intent(in) :: equilibrium
      type(monitor_set), intent(in) :: monitors
      type(event_log), intent(inout) :: log
      real(wp) :: slope
      integer :: k, i, offset

      log%count = log%count + 1
      associate (row => log%count, loop => model%loop, ledger => model%ledger, support => model%support%work, &
         solution => model%solution, release => model%release)
         log%reals(:, row) = [loop%lambda, found%hi%value, found%lo%value, stored_energy(model), ledger%external, &
            ledger%dissipated, ledger%cracked, ledger%work%bb, model%checks%residual, loop%scale, &
            support%ab + loop%lambda * support%bb]
         offset = 0
         if (loop%pending%group /= 0) then
            select type (group => model%mesh%holders(loop%pending%group)%group)
            class is (point_group)
               offset = group%offset
            end select
         end if
         log%integers(:, row) = [int(offset + loop%pending%point, c_int), int(loop%pending%code, c_int), &
            int(loop%events, c_int), merge(1_c_int, 0_c_int, equilibrium)]
         do k = 1, size(log%monitors, 1)
            associate (value => log%monitors(k, row), ratio => monitors%ratio(k))
               if (abs(ratio) > 0.0_wp) then
                  slope = ratio * (ledger%work%bb - support%bb)
                  value = ratio * (ledger%work%ba - support%ba) + loop%lambda * slope
               else
                  value = 0.0_wp
                  do i = int(monitors%first(k)), int(monitors%first(k + 1)) - 1
                     associate (q => monitors%equation(i))
                        value = value + monitors%share(i) * (solution%ua(q) + loop%lambda * solution%ub(q))
                     end associate
                  end do
                  slope = monitors%sum_of(k, solution%ub)
               end if
               value = loop%scale * value
            end associate
            if (k == 1) loop%slope = slope
         end do
         if (.not. release%active) return
         log%reals([4, log_reals], row) = [release%stored, release%force]
         do k = 1, size(log%monitors, 1)
            log%monitors(k, row) = 0.0_wp
            do i = int(monitors%first(k)), int(monitors%first(k + 1)) - 1
               associate (q => monitors%equation(i), from => release%from)
                  log%monitors(k, row) = log%monitors(k, row) + monitors%share(i) * (from(q) + &
                     release%part * (solution%ua(q) + loop%lambda * solution%ub(q) - from(q)))
               end associate
            end do
         end do
      end associate
   end subroutine record_state

   !> A monitor on which the reference load does its work follows from that work. The regions of the others are
   !> brought up to date in each event
   subroutine watch_monitors(model, monitors)
      type(element_model), intent(inout) :: model
      type(monitor_set), intent(inout) :: monitors
      real(wp), parameter :: same = 1.0e-12_wp
      integer :: i, k, n, greatest
      n = model%mesh%equations
      model%search%watched = .false.
      call watch_supports(model)
      associate (force => model%solution%force, fb => model%load%fb, equation => monitors%equation, &
         ratio => monitors%ratio)
         do k = 1, size(ratio)
            force = 0.0_wp
            do i = int(monitors%first(k)), int(monitors%first(k + 1)) - 1
               force(equation(i)) = force(equation(i)) + monitors%share(i)
            end do
            force(0) = 0.0_wp
            greatest = maxloc(abs(fb), dim=1) - 1
            ratio(k) = 0.0_wp
            if (abs(fb(greatest)) > 0.0_wp) ratio(k) = force(greatest) / fb(greatest)
            if (maxval(abs(force(0:n) - ratio(k) * fb)) <= same * maxval(abs(force))) then
               if (.not. any(abs(force(n + 1:)) > 0.0_wp)) cycle
            end if
            ratio(k) = 0.0_wp
            do i = int(monitors%first(k)), int(monitors%first(k + 1)) - 1
               if (equation(i) > 0 .and. equation(i) <= n) then
                  model%search%watched(model%search%tree%of(equation(i))) = .true.
               end if
            end do
         end do
      end associate
      model%search%wanted(:) = model%search%watched
   end subroutine watch_monitors

   !> The regions beside moved supports are brought up to date in each event
   subroutine watch_supports(model)
      type(element_model), intent(inout) :: model
      integer :: i, j, q
      do i = 1, size(model%support%beside, 2)
         associate (e => model%support%beside(2, i), group => model%mesh%holders(model%support%beside(1, i))%group)
            do j = 1, group%freedoms
               q = int(group%equation(j, e))
               if (q > 0 .and. q <= model%mesh%equations) model%search%watched(model%search%tree%of(q)) = .true.
            end do
         end associate
      end do
   end subroutine watch_supports

   !> Does the envelope of load over displacement stay below a fraction of its peak, over a tenth of the way to it? So
   !> do all states from the first one below it that is the furthest so far; a single tooth gives one such state
   subroutine judge_fall(model, reached, displacement, fallen)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: reached          !! load, or its multiplier
      real(wp), intent(in) :: displacement     !! of monitor 1 [m]
      logical, intent(out) :: fallen
      real(wp) :: way
      fallen = .false.
      associate (loop => model%loop, fraction => model%rules%fraction)
         if (fraction < 0.0_wp .or. .not. loop%peak > 0.0_wp) return
         way = sign(1.0_wp, loop%slope) * (displacement - loop%start_displacement)
         if (reached >= fraction * loop%peak) then
            loop%fallen_from = unbounded
         else if (loop%fallen_from < unbounded) then
            fallen = way >= loop%fallen_from + further * abs(loop%peak_displacement - loop%start_displacement)
         else if (way > loop%furthest) then
            loop%fallen_from = way
         end if
         loop%furthest = max(loop%furthest, way)
      end associate
   end subroutine judge_fall

end module sla_ledger
