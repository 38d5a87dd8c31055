!> Continuation where sequentially linear analysis finds no equilibrium under the constant loads.
!>
!> The run continues from the last state of the events, with their points, laws and damage, under displacement control,
!> by the steps of sla_iterations. A step in which displacements run away from the control has no equilibrium: the
!> constant loads are no longer carried.
module sla_continuation
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : code_arc => sla_event_dissipated, code_staggered => sla_event_staggered, &
      code_unbalanced => sla_event_unbalanced, &
      stop_axial => sla_stop_axial, stop_displacement => sla_stop_displacement, stop_far => sla_stop_far, &
      stop_fraction => sla_stop_fraction, stop_load => sla_stop_load, stop_mechanism => sla_stop_mechanism, &
      stop_none => sla_stop_none
   use common_status, only : status_cancelled, status_ok, status_out_of_memory
   use sla_bar, only : bar_group
   use sla_coaxial, only : by_frozen, by_secant
   use sla_group, only : history_group, point_group, unbounded
   use sla_iterations, only : evaluate, explicit_step, few, find_places, growth, has_friction, implicit_step, is_driven, &
      loads_run_away, longest_step
   use sla_ledger, only : event_log, judge_fall
   use sla_model, only : element_model
   use sla_regions, only : regions_settled
   use sla_state, only : load_work, monitor_set
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: model_continues, begin_path, resume_path, run_steps, path_histories

   !> Steps that are tried to end at a target, and how near to it a step must end, of its length
   integer, parameter :: most_trials = 12
   real(wp), parameter :: near = 1.0e-6_wp
   !> Times that a step without a state is tried again, each time by so small a part of it
   integer, parameter :: most_retreats = 3
   real(wp), parameter :: retreat = 0.25_wp
   !> First step over the longest
   real(wp), parameter :: first_step = 0.1_wp

contains

   !> Can all groups go on without teeth?
   pure function model_continues(model) result(yes)
      type(element_model), intent(in) :: model
      logical :: yes
      integer :: g
      yes = .true.
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            yes = yes .and. group%continues()
         class is (bar_group)
            yes = yes .and. group%is_elastic()
         class is (point_group)
            yes = .false.
         end select
      end do
   end function model_continues

   !> Take over the damage and the last state of the events; the first step, of no length, then finds equilibrium.
   !> Displacements that wait to be brought up to date are good enough to begin with
   subroutine begin_path(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      type(load_work) :: last
      real(wp) :: slope
      integer :: n, m, info
      n = model%mesh%equations
      m = size(model%support%moved, 1)
      status = status_ok
      associate (path => model%path, solution => model%solution, ledger => model%ledger)
         if (.not. allocated(path%start)) then
            allocate (path%u(0:n + m), path%now(0:n + m), path%before(0:n + m), path%push(0:n + m), &
               path%start(0:n + m), path%beside(merge(size(model%stiffness%row), 0, has_friction(model)), 2), stat=info)
            if (info /= 0) status = status_out_of_memory
            if (info /= 0) return
         end if
         path%active = .true.
         last = ledger%work - ledger%support_work
         path%lambda = ledger%lambda
         path%drive = ledger%lambda
         if (.not. is_driven(model)) path%drive = last%ba + ledger%lambda * last%bb
         path%constant = last%aa + ledger%lambda * last%ab
         path%drive_start = path%drive
         path%last_step = 0.0_wp
         path%gap = 0.0_wp
         path%released = 0.0_wp
         path%snaps = .false.
         path%most_stored = 0.0_wp
         path%steps = 0
         path%solutions = 0
         if (.not. is_driven(model)) then
            ! On the line ua + lambda ub, where the control is that of the last state
            slope = dot_product(model%load%fb, solution%ub(0:n))
            if (abs(slope) > 0.0_wp) path%lambda = (path%drive - dot_product(model%load%fb, solution%ua(0:n))) / slope
         end if
         path%u(:) = solution%ua + path%lambda * solution%ub
         path%start(:) = path%u
         path%now(:) = path%u
         path%before(:) = path%u
         path%lambda_now = path%lambda
         path%lambda_before = path%lambda
      end associate
      call find_places(model, status)
      if (status == status_ok) call begin_histories(model, status)
   end subroutine begin_path

   !> Those of all points by the teeth lost so far, at the path's displacements
   subroutine begin_histories(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: g
      status = status_ok
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            if (status == status_ok) call group%begin(model%path%u, status)
         end select
      end do
   end subroutine begin_histories

   !> Go on from the displacements and histories that a path of other loads and supports ended with; without histories
   !> from those of the teeth lost so far
   subroutine resume_path(model, displacement, histories, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: displacement(:, :)     !! (freedoms of a node, nodes) [m], [rad]
      real(wp), intent(in) :: histories(:, :)        !! (history_rows, points), or none
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: most(:)
      integer :: i, k, g, n, m, info
      n = model%mesh%equations
      m = size(model%support%moved, 1)
      call begin_path(model, status)
      if (status /= status_ok) return
      allocate (most(0:n + m), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      most(:) = 0.0_wp
      associate (path => model%path, mesh => model%mesh)
         do i = 1, mesh%nodes
            do k = 1, size(mesh%equation, 1)
               associate (q => mesh%equation(k, i), factor => mesh%factor(k, i))
                  if (q == 0 .or. abs(factor) <= most(q)) cycle
                  most(q) = abs(factor)
                  path%u(q) = displacement(k, i) / factor
               end associate
            end do
         end do
         path%u(n + 1:) = model%support%moved(:, 1)
         path%start(:) = path%u
         path%now(:) = path%u
         path%before(:) = path%u
         path%lambda = 0.0_wp
         path%lambda_now = 0.0_wp
         path%lambda_before = 0.0_wp
         path%drive = 0.0_wp
         if (.not. is_driven(model)) path%drive = dot_product(model%load%fb, path%u(0:n))
         path%drive_start = path%drive
         path%constant = dot_product(model%load%fa, path%u(0:n))
      end associate
      if (size(histories, 2) == 0) call begin_histories(model, status)
      do g = 1, merge(size(model%mesh%holders), 0, size(histories, 2) > 0)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            associate (rows => size(group%history, 1))
               group%history(:, :) = histories(1:rows, group%offset + 1:group%offset + group%points)
            end associate
            call group%keep()
            group%rate(:, :) = 0.0_wp
         end select
      end do
      model%ledger%recorded = .true.
   end subroutine resume_path

   !> Histories of all points in the last state
   pure subroutine path_histories(model, histories)
      type(element_model), intent(in) :: model
      real(wp), intent(out) :: histories(:, :)       !! (history_rows, points)
      integer :: g
      histories = 0.0_wp
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            if (allocated(group%kept)) then
               histories(1:size(group%kept, 1), group%offset + 1:group%offset + group%points) = group%kept
            end if
         end select
      end do
   end subroutine path_histories

   !> Up to `room` steps; the first finds equilibrium where the events ended
   subroutine run_steps(model, monitors, log, reason, status)
      type(element_model), intent(inout) :: model
      type(monitor_set), intent(in) :: monitors
      type(event_log), intent(inout) :: log
      integer(c_int), intent(out) :: reason
      integer(c_int), intent(out) :: status
      real(wp) :: lost, load, length, scale
      integer(c_int) :: code
      real(wp) :: part
      integer :: iterations, trials, retreats, g
      logical :: carried, fallen, last
      reason = stop_none
      status = status_ok
      associate (path => model%path, loop => model%loop)
         do while (log%count < size(log%reals, 2) .and. reason == stop_none)
            if (cancel_requested()) status = status_cancelled
            if (status /= status_ok) exit
            length = path%step
            if (path%steps == 0) then
               length = 0.0_wp
               call evaluate(model, by_frozen, .false., path%stored, scale)
            end if
            retreats = 0
            do trials = 1, most_trials
               lost = 0.0_wp
               last = retreats == most_retreats .or. .not. abs(length) > 0.0_wp .or. trials == most_trials
               if (path%implicit .or. path%steps < 2) then
                  call implicit_step(model, length, last, code, iterations, carried, lost, status)
               else
                  call explicit_step(model, length, code, carried, lost, status)
                  iterations = few
               end if
               if (status /= status_ok) exit
               if (.not. carried) then
                  if (last) exit
                  retreats = retreats + 1
                  call restore_state(model)
                  length = retreat * length
                  path%step = retreat * path%step
                  cycle
               end if
               if (code == code_arc) length = dot_product(model%load%fb, path%u(0:model%mesh%equations)) - path%drive
               part = part_to_target(model, monitors)
               if (part < 1.0_wp) path%snaps = .false.
               if (part >= 1.0_wp - near .or. trials == most_trials) exit
               call restore_state(model)
               length = part * length
            end do
            if (.not. carried) reason = merge(stop_axial, stop_mechanism, loads_run_away(model))
            if (status /= status_ok .or. .not. carried) then
               call restore_state(model)
               exit
            end if
            call account_step(model, length, code, lost, status)
            if (status /= status_ok) exit
            if (path%steps == 0) then
               path%start(:) = path%now
               path%drive_start = path%drive
               path%step = first_step * longest_step(model)
            end if
            path%steps = path%steps + 1
            loop%events = loop%events + 1
            call record_step(model, monitors, code, log)
            associate (way => log%monitors(1, log%count))
               load = merge(path%force, loop%lambda + model%rules%already, is_driven(model))
               if (load > loop%peak) then
                  loop%peak = load
                  loop%peak_displacement = way
               end if
               loop%slope = 1.0_wp
               if (way < loop%start_displacement) loop%slope = -1.0_wp
               call judge_fall(model, load, way, fallen)
               if (fallen) reason = stop_fraction
               if (abs(way - loop%start_displacement) > model%rules%far) reason = stop_far
               if (abs(way) >= model%rules%displacement * (1.0_wp - near)) reason = stop_displacement
               if (abs(model%rules%side) > 0.0_wp .and. model%rules%side * (way - model%rules%target) >= &
                  -near * abs(way - loop%start_displacement)) reason = stop_displacement
               if (loop%lambda >= model%rules%lambda * (1.0_wp - near)) reason = stop_load
            end associate
            if (path%implicit .and. path%steps > 1 .and. iterations < few) then
              path%step = min(growth * path%step, longest_step(model))
            end if
         end do
         do g = 1, size(model%mesh%holders)
            select type (group => model%mesh%holders(g)%group)
            class is (history_group)
               call group%show(path%now)
            end select
         end do
         model%solution%ua(:) = path%now
         model%solution%ub(:) = 0.0_wp
         call regions_settled(model%search%tree, model%solution%ua, model%solution%ub)
      end associate
   end subroutine run_steps

   !> The part of a step after which the run ends at a displacement or a multiplier, by linear interpolation; else 1
   pure function part_to_target(model, monitors) result(part)
      type(element_model), intent(in) :: model
      type(monitor_set), intent(in) :: monitors
      real(wp) :: part, was, is
      part = 1.0_wp
      was = monitors%sum_of(1, model%path%now)
      is = monitors%sum_of(1, model%path%u)
      associate (rules => model%rules, path => model%path)
         if (abs(rules%side) > 0.0_wp) part = min(part, &
            share(rules%side * was, rules%side * is, rules%side * rules%target))
         if (rules%displacement < unbounded) part = min(part, share(abs(was), abs(is), rules%displacement))
         if (rules%lambda < unbounded) part = min(part, share(path%lambda_now, path%lambda, rules%lambda))
      end associate

   contains

      pure function share(from, to, at) result(of)
         real(wp), intent(in) :: from, to, at
         real(wp) :: of
         of = 1.0_wp
         if (to > at .and. from < at) of = (at - from) / (to - from)
      end function share

   end function part_to_target

   !> Back to the last state
   subroutine restore_state(model)
      type(element_model), intent(inout) :: model
      integer :: g
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            call group%restore()
         end select
      end do
      model%path%u(:) = model%path%now
      model%path%lambda = model%path%lambda_now
   end subroutine restore_state

   !> The state is taken: energies, and what the next step begins with
   subroutine account_step(model, length, code, lost, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer(c_int), intent(in) :: code       !! of the list sla_event
      real(wp), intent(in) :: lost             !! [J]
      integer(c_int), intent(out) :: status
      real(wp) :: energy, scale, force, was, released
      integer :: g, n, m
      n = model%mesh%equations
      m = size(model%support%moved, 1)
      status = status_ok
      associate (path => model%path, ledger => model%ledger, loop => model%loop)
         call evaluate(model, by_secant, .false., energy, scale)
         force = path%lambda
         was = path%lambda_now
         if (is_driven(model)) then
            force = dot_product(model%solution%force(n + 1:n + m), model%support%moved(:, 2))
            was = path%force
         end if
         if (path%steps == 0) was = force
         ledger%external = ledger%external + 0.5_wp * (was + force) * length + &
            dot_product(model%load%fa, path%u(0:n)) - path%constant
         path%constant = dot_product(model%load%fa, path%u(0:n))
         ledger%dissipated = ledger%dissipated + lost
         ledger%cracked = ledger%cracked + lost
         ! A staggered step may drop to another equilibrium: the energy between both becomes motion, and is lost. In the
         ! first step the teeth become their law, and the springs by which events soften the cohesion slip that stays
         released = ledger%external - energy - ledger%dissipated - path%gap
         if ((code == code_staggered .or. code == code_unbalanced) .and. released > 0.0_wp) then
            ledger%dissipated = ledger%dissipated + released
            path%released = path%released + released
         end if
         path%gap = ledger%external - energy - ledger%dissipated
         path%force = force
         path%stored = energy
         path%most_stored = max(path%most_stored, energy)
         path%before(:) = path%now
         path%lambda_before = path%lambda_now
         path%now(:) = path%u
         path%lambda_now = path%lambda
         path%last_step = length
         path%drive = path%drive + length
         loop%lambda = path%lambda
         loop%lambda_held = path%lambda
         do g = 1, size(model%mesh%holders)
            select type (group => model%mesh%holders(g)%group)
            class is (history_group)
               call group%keep()
            end select
         end do
      end associate
   end subroutine account_step

   !> One row of the log; a step has no limits and no compliance
   subroutine record_step(model, monitors, code, log)
      type(element_model), intent(in) :: model
      type(monitor_set), intent(in) :: monitors
      integer(c_int), intent(in) :: code
      type(event_log), intent(inout) :: log
      integer :: k
      log%count = log%count + 1
      associate (row => log%count, path => model%path, ledger => model%ledger)
         log%reals(:, row) = [path%lambda_now, unbounded, -unbounded, path%stored, ledger%external, ledger%dissipated, &
            ledger%cracked, 0.0_wp, path%residual, 1.0_wp, path%force]
         log%integers(:, row) = [0_c_int, code, int(model%loop%events, c_int), &
            merge(0_c_int, 1_c_int, code == code_unbalanced)]
         do k = 1, size(log%monitors, 1)
            log%monitors(k, row) = monitors%sum_of(k, path%now)
         end do
      end associate
   end subroutine record_step

end module sla_continuation
