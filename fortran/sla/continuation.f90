!> Equilibrium iterations where sequentially linear analysis finds no equilibrium under the constant loads.
!>
!> The run goes on from the last state of the events, with their points, laws and damage, under displacement control:
!> each step prescribes the displacement on which the reference load does its work (fb.u, or the movement of supports)
!> and finds displacements and multiplier in equilibrium by the total law of the points (sla_coaxial).
!>
!>   Newton      with the tangent of histories that grow with the strain, halving a step that does not lower the
!>               residual; where no step does, three iterations with the secant matrix
!>   staggered   where Newton stalls: damage frozen, Newton on the convex energy with Armijo's rule; histories follow;
!>               again until the new damage leaves no force out of balance. Damage only grows and is bounded
!>
!> A step in which displacements run away from the control has no equilibrium: the constant loads are no longer
!> carried. Implicit-explicit integration (Oliver, Huespe and Cante 2008) is the alternative: histories that go on at
!> the rate of the last step, one convex problem a step, and a step length from the force that this leaves out of
!> balance.
module sla_continuation
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : code_newton => sla_event_newton, code_staggered => sla_event_staggered, &
      code_extrapolated => sla_event_extrapolated, code_unbalanced => sla_event_unbalanced, &
      stop_axial => sla_stop_axial, stop_displacement => sla_stop_displacement, stop_far => sla_stop_far, &
      stop_fraction => sla_stop_fraction, stop_load => sla_stop_load, stop_mechanism => sla_stop_mechanism, &
      stop_none => sla_stop_none
   use common_status, only : status_cancelled, status_not_positive_definite, status_ok, status_out_of_memory
   use sla_assembly, only : position
   use sla_c_bindings, only : extrados_sparse_indefinite
   use sla_coaxial, only : by_frozen, by_secant, by_tangent
   use sla_group, only : element_group, history_group, most_entries, point_group, unbounded
   use sla_ledger, only : event_log, judge_fall
   use sla_model, only : element_model
   use sla_regions, only : regions_settled
   use sla_state, only : load_work, monitor_set
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: model_continues, begin_path, resume_path, run_steps, path_histories

   !> Residual over the largest nodal force; of the convex problems
   real(wp), parameter :: tolerance = 1.0e-4_wp, inner_tolerance = 1.0e-5_wp
   integer, parameter :: most_newton = 12, most_loops = 300, most_inner = 40, most_halvings = 4
   !> Iterations of a step after which the next may be longer
   integer, parameter :: few = 10
   real(wp), parameter :: growth = 1.5_wp
   !> Steps that are tried to end at a target, and how near to it a step must end, of its length
   integer, parameter :: most_trials = 8
   real(wp), parameter :: near = 1.0e-6_wp
   !> Of the greatest displacement: no step is longer
   real(wp), parameter :: part_of_way = 0.1_wp
   !> First step over the longest
   real(wp), parameter :: first_step = 0.1_wp
   !> Displacement over that of the control beyond which a structure has run away
   real(wp), parameter :: farthest = 5.0_wp
   !> Force that extrapolated damage may leave out of balance, over the largest nodal force
   real(wp), parameter :: explicit_tolerance = 5.0e-3_wp
   !> Times that force beyond which such a step is no state in equilibrium
   real(wp), parameter :: largest_error = 4.0_wp

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
      integer :: g, n, m, info
      n = model%mesh%equations
      m = size(model%support%moved, 1)
      status = status_ok
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            if (status == status_ok) call group%begin(status)
         end select
      end do
      if (status /= status_ok) return
      associate (path => model%path, solution => model%solution, ledger => model%ledger)
         if (.not. allocated(path%start)) then
            allocate (path%u(0:n + m), path%now(0:n + m), path%before(0:n + m), path%push(0:n + m), &
               path%start(0:n + m), stat=info)
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
   end subroutine begin_path

   !> Go on from the displacements and histories that a path of other loads and supports ended with
   subroutine resume_path(model, displacement, histories, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: displacement(:, :)     !! (freedoms of a node, nodes) [m], [rad]
      real(wp), intent(in) :: histories(:, :)        !! (2, points)
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
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            group%history(:, :) = histories(:, group%offset + 1:group%offset + group%points)
            call group%keep()
            group%rate(:, :) = 0.0_wp
         end select
      end do
      model%ledger%recorded = .true.
   end subroutine resume_path

   !> Histories of all points in the last state
   pure subroutine path_histories(model, histories)
      type(element_model), intent(in) :: model
      real(wp), intent(out) :: histories(:, :)       !! (2, points)
      integer :: g
      histories = 0.0_wp
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            if (allocated(group%kept)) histories(:, group%offset + 1:group%offset + group%points) = group%kept
         end select
      end do
   end subroutine path_histories

   !> Do supports move with the multiplier?
   pure function is_driven(model) result(yes)
      type(element_model), intent(in) :: model
      logical :: yes
      yes = any(abs(model%support%moved(:, 2)) > 0.0_wp)
   end function is_driven

   !> Up to `room` steps; the first finds equilibrium where the events ended
   subroutine run_steps(model, monitors, log, reason, status)
      type(element_model), intent(inout) :: model
      type(monitor_set), intent(in) :: monitors
      type(event_log), intent(inout) :: log
      integer(c_int), intent(out) :: reason
      integer(c_int), intent(out) :: status
      real(wp) :: lost, load, length
      integer(c_int) :: code
      real(wp) :: part
      integer :: iterations, trials, g
      logical :: carried, fallen
      reason = stop_none
      status = status_ok
      associate (path => model%path, loop => model%loop)
         do while (log%count < size(log%reals, 2) .and. reason == stop_none)
            if (cancel_requested()) status = status_cancelled
            if (status /= status_ok) exit
            length = path%step
            if (path%steps == 0) length = 0.0_wp
            do trials = 1, most_trials
               lost = 0.0_wp
               if (path%implicit .or. path%steps < 2) then
                  call implicit_step(model, length, code, iterations, carried, lost, status)
               else
                  call explicit_step(model, length, code, carried, lost, status)
                  iterations = few
               end if
               if (status /= status_ok .or. .not. carried) exit
               part = part_to_target(model, monitors)
               if (part >= 1.0_wp - near .or. trials == most_trials) exit
               call restore_state(model)
               length = part * length
            end do
            ! without constant loads nothing but the growing one carries it away
            if (.not. carried) reason = merge(stop_axial, stop_mechanism, any(model%load%fa /= 0.0_wp))
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
              path%step = min(growth * path%step, path%longest)
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

   !> Newton's method, then the staggered one
   subroutine implicit_step(model, length, code, iterations, carried, lost, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length           !! of the control [J]
      integer(c_int), intent(out) :: code      !! of the list sla_event
      integer, intent(out) :: iterations
      logical, intent(out) :: carried
      real(wp), intent(inout) :: lost          !! [J]
      integer(c_int), intent(out) :: status
      logical :: found
      carried = .true.
      code = code_newton
      found = .false.
      status = status_ok
      if (abs(length) > 0.0_wp) then
         call predict(model, length, status)
         if (status == status_ok) call newton_step(model, length, iterations, found, status)
      end if
      if (status == status_ok .and. .not. found) then
         code = code_staggered
         call predict(model, length, status)
         if (status == status_ok) call staggered_step(model, length, iterations, found, carried, lost, status)
         if (.not. found) code = code_unbalanced
      end if
      if (status == status_ok .and. carried) call update_all(model, lost)
   end subroutine implicit_step

   !> Displacements and multiplier at the end of a step: the last two states extrapolated, or by the secant matrix
   subroutine predict(model, length, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer(c_int), intent(out) :: status
      real(wp) :: ratio, scale, energy
      status = status_ok
      associate (path => model%path)
         path%u(:) = path%now
         path%lambda = path%lambda_now
         if (.not. abs(length) > 0.0_wp) return
         if (path%last_step > 0.0_wp) then
            ratio = length / path%last_step
            path%u(:) = path%now + ratio * (path%now - path%before)
            path%lambda = path%lambda_now + ratio * (path%lambda_now - path%lambda_before)
            return
         end if
         call evaluate(model, by_frozen, .true., energy, scale)
         call correct(model, path%drive + length, status)
         if (status == status_ok) call move(model, 1.0_wp)
      end associate
   end subroutine predict

   !> Forces, and where wanted the matrix, of the path's displacements; residual forces go into solution%force
   subroutine evaluate(model, how, whole, energy, scale)
      type(element_model), intent(inout) :: model
      integer, intent(in) :: how               !! by_... of sla_coaxial
      logical, intent(in) :: whole             !! with the matrix
      real(wp), intent(out) :: energy          !! stored [J]
      real(wp), intent(out) :: scale           !! largest nodal force of an element [N]
      real(wp) :: local(most_entries), f(most_entries), k(most_entries, most_entries), part
      integer :: g, e, i, n
      n = model%mesh%equations
      energy = 0.0_wp
      scale = 0.0_wp
      model%solution%force(:) = 0.0_wp
      if (whole) then
         model%stiffness%value(:) = 0.0_wp
         model%path%push(:) = 0.0_wp
      end if
      do g = 1, size(model%mesh%holders)
         associate (group => model%mesh%holders(g)%group, force => model%solution%force)
            do e = 1, group%elements
               call group%gather(e, model%path%u, local)
               call respond(group, e, local, how, f, k, part)
               energy = energy + part
               do i = 1, group%freedoms
                  force(group%equation(i, e)) = force(group%equation(i, e)) + f(i) * group%factor(i, e)
                  scale = max(scale, abs(f(i)))
               end do
               if (whole) call add_matrix(model, group, e, k)
            end do
         end associate
      end do
      model%solution%force(0) = 0.0_wp
      model%solution%force(0:n) = model%solution%force(0:n) - model%load%fa - model%path%lambda * model%load%fb
   end subroutine evaluate

   !> Response of an element; what has no histories is linear
   pure subroutine respond(group, e, local, how, f, k, energy)
      class(element_group), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      integer, intent(in) :: how
      real(wp), intent(out) :: f(:)
      real(wp), intent(out) :: k(:, :)
      real(wp), intent(out) :: energy
      integer :: i, n
      select type (group)
      class is (history_group)
         call group%respond(e, local, how, f, k, energy)
      class default
         n = group%freedoms
         call group%matrix(e, k)
         do i = 1, n
            f(i) = dot_product(k(i, 1:n), local(1:n))
         end do
         energy = 0.5_wp * dot_product(f(1:n), local(1:n))
      end select
   end subroutine respond

   !> An element's matrix into that of the unknowns, and the forces by which moved supports act on them
   pure subroutine add_matrix(model, group, e, k)
      type(element_model), intent(inout) :: model
      class(element_group), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: k(:, :)
      integer :: i, j, n, row, column
      real(wp) :: value
      n = model%mesh%equations
      do j = 1, group%freedoms
         column = int(group%equation(j, e))
         if (column == 0) cycle
         do i = 1, group%freedoms
            row = int(group%equation(i, e))
            if (row == 0) cycle
            value = k(i, j) * group%factor(i, e) * group%factor(j, e)
            if (column > n) then
               model%path%push(row) = model%path%push(row) + value * model%support%moved(column - n, 2)
            else if (row >= column .and. row <= n) then
               associate (at => position(model%stiffness%start, model%stiffness%row, row, column))
                  model%stiffness%value(at) = model%stiffness%value(at) + value
               end associate
            end if
         end do
      end do
   end subroutine add_matrix

   !> Residual over the largest nodal force; the equations of supports have none
   pure function residual_of(model, scale) result(ratio)
      type(element_model), intent(in) :: model
      real(wp), intent(in) :: scale
      real(wp) :: ratio
      ratio = maxval(abs(model%solution%force(1:model%mesh%equations)))
      if (scale > 0.0_wp) ratio = ratio / scale
   end function residual_of

   !> The change of displacements and multiplier that takes the linearised residual away at a value of the control: into
   !> z(:, 1), and the multiplier's into z's second column by `step_of`
   subroutine correct(model, target, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: target           !! of the control [J]
      integer(c_int), intent(out) :: status
      real(wp) :: change, slope
      integer :: n
      n = model%mesh%equations
      associate (path => model%path, z => model%solution%z, fb => model%load%fb)
         z(:, 1) = -model%solution%force(1:n)
         z(:, 2) = fb(1:n) - path%push(1:n)
         status = extrados_sparse_indefinite(model%stiffness%factor, model%stiffness%value, 2_c_int, z)
         path%solutions = path%solutions + 1
         if (status /= status_ok) return
         if (is_driven(model)) then
            change = target - path%lambda
         else
            slope = dot_product(fb(1:n), z(:, 2))
            change = target - dot_product(fb, path%u(0:n)) - dot_product(fb(1:n), z(:, 1))
            change = merge(change / slope, 0.0_wp, abs(slope) > 0.0_wp)
         end if
         z(:, 1) = z(:, 1) + change * z(:, 2)
         z(1, 2) = change
         if (.not. all(abs(z(:, 1)) <= unbounded)) status = status_not_positive_definite
      end associate
   end subroutine correct

   !> Go a part of the way of the last correction
   pure subroutine move(model, part)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: part
      integer :: n, m
      n = model%mesh%equations
      m = size(model%support%moved, 1)
      associate (path => model%path, z => model%solution%z)
         path%u(1:n) = path%u(1:n) + part * z(:, 1)
         path%lambda = path%lambda + part * z(1, 2)
         path%u(n + 1:n + m) = model%support%moved(:, 1) + path%lambda * model%support%moved(:, 2)
      end associate
   end subroutine move

   !> Newton's method by the tangent, with a line search on the residual
   subroutine newton_step(model, length, iterations, found, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer, intent(out) :: iterations
      logical, intent(out) :: found
      integer(c_int), intent(out) :: status
      real(wp) :: energy, scale, ratio, trial, part
      integer :: secants, i
      status = status_ok
      secants = 0
      found = .false.
      do iterations = 0, most_newton
         call evaluate(model, merge(by_secant, by_tangent, secants > 0), .true., energy, scale)
         ratio = residual_of(model, scale)
         model%path%residual = ratio
         found = ratio < tolerance .and. iterations > 0
         if (found .or. .not. ratio <= unbounded) return
         call correct(model, model%path%drive + length, status)
         if (status == status_not_positive_definite) then
            status = status_ok
            return
         end if
         if (status /= status_ok) return
         if (secants > 0) then
            secants = secants - 1
            call move(model, 1.0_wp)
            cycle
         end if
         part = 1.0_wp
         call move(model, part)
         do i = 0, most_halvings
            call evaluate(model, by_secant, .false., energy, scale)
            trial = residual_of(model, scale)
            if (trial <= 0.9_wp * ratio .or. i == most_halvings) exit
            call move(model, -0.5_wp * part)
            part = 0.5_wp * part
         end do
         if (iterations > 0 .and. .not. trial <= 0.95_wp * ratio) secants = 3
      end do
   end subroutine newton_step

   !> Damage frozen, then updated, until nothing changes
   subroutine staggered_step(model, length, iterations, found, carried, lost, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer, intent(out) :: iterations
      logical, intent(out) :: found
      logical, intent(out) :: carried
      real(wp), intent(inout) :: lost
      integer(c_int), intent(out) :: status
      real(wp) :: energy, scale
      found = .false.
      carried = .true.
      do iterations = 1, most_loops
         call frozen_solution(model, length, status)
         if (status /= status_ok) return
         carried = .not. has_run_away(model, length)
         if (.not. carried) return
         call update_all(model, lost)
         call evaluate(model, by_frozen, .false., energy, scale)
         model%path%residual = residual_of(model, scale)
         found = model%path%residual < tolerance
         if (found) return
         if (cancel_requested()) status = status_cancelled
         if (status /= status_ok) return
      end do
   end subroutine staggered_step

   !> The one equilibrium at the present damage: Newton's method on a convex energy
   subroutine frozen_solution(model, length, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer(c_int), intent(out) :: status
      real(wp) :: energy, scale, before, slope, part, trial
      integer :: i, k, n
      n = model%mesh%equations
      status = status_ok
      do i = 0, most_inner
         call evaluate(model, by_frozen, .true., energy, scale)
         if (residual_of(model, scale) < inner_tolerance .and. i > 0) return
         before = energy - dot_product(model%load%fa, model%path%u(0:n))
         call correct(model, model%path%drive + length, status)
         if (status /= status_ok) return
         slope = dot_product(model%solution%force(1:n) + model%path%lambda * model%load%fb(1:n), model%solution%z(:, 1))
         part = 1.0_wp
         call move(model, part)
         if (i == 0) cycle          ! to the control's value
         do k = 1, 10
            call evaluate(model, by_frozen, .false., trial, scale)
            trial = trial - dot_product(model%load%fa, model%path%u(0:n))
            if (trial <= before + 1.0e-4_wp * part * slope + 1.0e-12_wp * abs(before)) exit
            call move(model, -0.5_wp * part)
            part = 0.5_wp * part
         end do
      end do
   end subroutine frozen_solution

   !> One convex problem with histories that go on at the rate of the last step; the step is then adapted to its error
   subroutine explicit_step(model, length, code, carried, lost, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer(c_int), intent(out) :: code
      logical, intent(out) :: carried
      real(wp), intent(inout) :: lost
      integer(c_int), intent(out) :: status
      real(wp) :: energy, scale, ratio
      integer :: g
      code = code_extrapolated
      carried = .true.
      ratio = 0.0_wp
      if (model%path%last_step > 0.0_wp) ratio = length / model%path%last_step
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            call group%extrapolate(ratio)
         end select
      end do
      call predict(model, length, status)
      if (status == status_ok) call frozen_solution(model, length, status)
      if (status /= status_ok) return
      carried = .not. has_run_away(model, length)
      if (.not. carried) return
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            call group%restore()
         end select
      end do
      call update_all(model, lost)
      call evaluate(model, by_frozen, .false., energy, scale)
      model%path%residual = residual_of(model, scale)
      if (model%path%residual > largest_error * explicit_tolerance) code = code_unbalanced
      ratio = sqrt(explicit_tolerance / max(model%path%residual, 1.0e-12_wp))
      model%path%step = min(model%path%step * min(max(ratio, 1.0_wp / growth), growth), longest_step(model))
   end subroutine explicit_step

   !> No step is longer than a part of the displacements so far: stiff structures lose equilibrium early
   pure function longest_step(model) result(step)
      type(element_model), intent(in) :: model
      real(wp) :: step
      associate (path => model%path)
         step = min(path%longest, part_of_way * path%unit * maxval(abs(path%now(1:model%mesh%equations))))
         if (.not. step > 0.0_wp) step = path%longest
      end associate
   end function longest_step

   !> Have displacements left those of the control behind?
   pure function has_run_away(model, length) result(yes)
      type(element_model), intent(in) :: model
      real(wp), intent(in) :: length
      logical :: yes
      associate (path => model%path)
         yes = maxval(abs(path%u(1:model%mesh%equations) - path%start(1:model%mesh%equations))) > &
            max(farthest * abs(path%drive + length - path%drive_start) / path%unit, path%least_runaway)
      end associate
   end function has_run_away

   !> All histories follow the displacements
   subroutine update_all(model, lost)
      type(element_model), intent(inout) :: model
      real(wp), intent(inout) :: lost          !! [J]
      integer :: g
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            call group%update(model%path%u, lost)
         end select
      end do
   end subroutine update_all

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
         call evaluate(model, by_frozen, .false., energy, scale)
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
         ! A staggered step may drop to another equilibrium: the energy between both becomes motion, and is lost
         released = ledger%external - energy - ledger%dissipated - path%gap
         if ((code == code_staggered .or. code == code_unbalanced) .and. path%steps > 0 .and. released > 0.0_wp) then
            ledger%dissipated = ledger%dissipated + released
            path%released = path%released + released
         end if
         path%gap = ledger%external - energy - ledger%dissipated
         path%force = force
         path%stored = energy
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
