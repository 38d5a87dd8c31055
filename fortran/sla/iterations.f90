!> One step of equilibrium iterations under displacement control, for sla_continuation.
!>
!> A step prescribes the displacement on which the reference load does its work (fb.u, or the movement of supports) and
!> finds displacements and multiplier in equilibrium by the total law of the points (sla_coaxial).
!>
!>   Newton      with the tangent of histories that grow with the strain, halving a step that does not lower the
!>               residual; where no step does, three iterations with the secant matrix
!>   staggered   where Newton stalls: damage frozen, Newton on the convex energy with Armijo's rule; histories follow;
!>               again until the new damage leaves no force out of balance. Damage only grows and is bounded
!>   descent     instead of the staggered step where no joint slides, so that the forces have a potential: secant matrix,
!>               corrected by pairs of changes (sla_secant_pairs), and a line search on the work of the forces out of
!>               balance (Crisfield 1991, 9.2); histories follow after each way. Without pairs and search this is the
!>               staggered step with one solution a loop
!>   arc length  where displacements snap back, where asked for: Newton with a prescribed dissipation in the step (Gutierrez 2004;
!>               Verhoosel, Remmers and Gutierrez 2009). Displacements and multiplier change by du and dl from u0 and l0;
!>               damaged points unload to the origin, so that twice the dissipated energy is (fa + l0 fb).du - dl fb.u0
!>   explicit    implicit-explicit integration (Oliver, Huespe and Cante 2008): histories that continue at the rate of
!>               the last step, one convex problem a step, and a step length from the force that this leaves out of
!>               balance
module sla_iterations
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_lists, only : code_arc => sla_event_dissipated, code_newton => sla_event_newton, &
      code_staggered => sla_event_staggered, code_extrapolated => sla_event_extrapolated, code_unbalanced => sla_event_unbalanced
   use common_status, only : status_cancelled, status_not_positive_definite, status_ok, status_out_of_memory
   use sla_assembly, only : position
   use sla_c_bindings, only : extrados_sparse_again, extrados_sparse_indefinite
   use sla_coaxial, only : by_frozen, by_secant, by_tangent
   use sla_group, only : element_group, friction_group, history_group, most_entries, unbounded
   use sla_model, only : element_model
   use sla_secant_pairs, only : pair_memory
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: find_places, implicit_step, explicit_step, evaluate, has_friction, is_driven, longest_step, loads_run_away, few, growth

   !> Residual over the largest nodal force: of Newton's method, of staggered steps, which approach it slowly, of the
   !> convex problems
   real(wp), parameter :: tolerance = 1.0e-4_wp, staggered_tolerance = 1.0e-3_wp, inner_tolerance = 1.0e-5_wp
   !> Times the damage of a staggered loop by which damage goes on at most, and the ratio of residuals from which it does
   real(wp), parameter :: most_ahead = 3.0_wp, slow = 0.5_wp
   !> Loops before that: damage ahead of a snap that soon ends lowers the load by some per cent
   integer, parameter :: many_loops = 16
   integer, parameter :: most_newton = 12, most_loops = 300, most_inner = 40, most_halvings = 4
   !> Iterations in which Newton's method must halve the residual
   integer, parameter :: most_vain = 4
   !> Work of the forces out of balance at the end of a way over that at its start, at most: where they still drive it, and where
   !> they oppose it, as damage that goes too far stays; factors by which a way is longer and shorter than the last one tried,
   !> the longest way, and the trials
   real(wp), parameter :: most_driving = 0.7_wp, most_opposing = 0.1_wp, longer(2) = [1.5_wp, 2.0_wp], shorter = 0.1_wp, &
      longest_way = 4.0_wp
   integer, parameter :: most_searches = 6
   !> Energy that the error of the trapezium rule may take in a step of descent, over the greatest stored
   real(wp), parameter :: most_taken = 2.0e-3_wp
   !> Loop of a staggered step after which Newton's method tries first, and then each time twice as many later
   integer, parameter :: first_try = 4
   !> Vectors of the solution with sliding friction, and the part of the right side that may be left
   integer, parameter :: most_krylov = 40
   real(wp), parameter :: krylov_tolerance = 1.0e-6_wp
   !> Iterations of a step after which the next may be longer
   integer, parameter :: few = 10
   real(wp), parameter :: growth = 1.5_wp
   !> Of the greatest displacement: no step is longer
   real(wp), parameter :: part_of_way = 0.1_wp
   !> Times the displacement of the control that the constant loads may follow their own direction, on the average of
   !> their forces, and that anything may move: rocking raises the loads, and parts that rotate far from the control
   !> move many times as far
   real(wp), parameter :: farthest = 5.0_wp, farthest_of_all = 500.0_wp
   !> Of the greatest displacement: so far, on the average, the constant loads have followed their own direction
   real(wp), parameter :: share_of_loads = 1.0e-3_wp
   !> Force that extrapolated damage may leave out of balance, over the largest nodal force
   real(wp), parameter :: explicit_tolerance = 5.0e-3_wp
   !> Of the greatest energy stored so far: dissipated in the first step of an arc length and at most in one; dissipated in a
   !> step of the control beyond which it may have snapped
   real(wp), parameter :: first_part = 0.005_wp, most_part = 0.02_wp, snap_part = 0.03_wp
   !> Times that such a step is tried, each time by so small a part of it, and the error of its dissipation
   integer, parameter :: most_arcs = 5
   real(wp), parameter :: less = 0.25_wp, arc_tolerance = 1.0e-3_wp
   !> Of the prescribed dissipation: so much at least is that of damage
   real(wp), parameter :: least_share = 0.5_wp
   !> Times that force beyond which such a step is no state in equilibrium
   real(wp), parameter :: largest_error = 4.0_wp

contains

   !> Do supports move with the multiplier?
   pure function is_driven(model) result(yes)
      type(element_model), intent(in) :: model
      logical :: yes
      yes = any(abs(model%support%moved(:, 2)) > 0.0_wp)
   end function is_driven

   !> Are there joints that can slide?
   pure function has_friction(model) result(yes)
      type(element_model), intent(in) :: model
      logical :: yes
      integer :: g
      yes = .false.
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (friction_group)
            yes = yes .or. group%slides
         end select
      end do
   end function has_friction

   !> Newton's method, then the staggered one. Ways of descent that run away may have gone too far with the damage: of the `last`
   !> step to be tried the staggered one decides
   subroutine implicit_step(model, length, last, code, iterations, carried, lost, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length           !! of the control [J]
      logical, intent(in) :: last              !! no shorter step follows
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
         if (.not. model%path%snaps) then
            call predict(model, length, status)
            if (status == status_ok) call newton_step(model, length, iterations, found, status)
            if (found) found = .not. has_run_away(model, length)
            if (found .and. model%path%by_energy) found = dissipation(model) <= snap_part * model%path%most_stored
         end if
         if (status == status_ok .and. .not. found .and. model%path%by_energy .and. .not. is_driven(model)) then
            code = code_arc
            call arc_step(model, length, iterations, found, status)
         end if
      end if
      if (status == status_ok .and. .not. found) then
         code = code_staggered
         call predict(model, length, status)
         if (status == status_ok .and. has_friction(model)) then
            call staggered_step(model, length, iterations, found, carried, lost, status)
         else if (status == status_ok) then
            call descent_step(model, length, iterations, found, carried, lost, status)
            if (found) then
               ! Newton's method may have ended it with damage that no loop has seen
               call update_all(model, lost)
               found = takes_no_energy(model, length, lost)
            end if
            if (status == status_ok .and. (carried .or. last) .and. .not. found) then
               ! Damage that went ahead of the forces costs more than their work: the slow way, from the last state
               call restore_histories(model)
               lost = 0.0_wp
               call predict(model, length, status)
               if (status == status_ok) call staggered_step(model, length, iterations, found, carried, lost, status)
            end if
         end if
         if (.not. found) code = code_unbalanced
      end if
      if (status == status_ok .and. carried) call update_all(model, lost)
   end subroutine implicit_step

   !> Is what the step has lost and stored no more than the work of its loads, but for the error of the trapezium rule?
   function takes_no_energy(model, length, lost) result(yes)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length           !! of the control [J]
      real(wp), intent(in) :: lost             !! [J]
      logical :: yes
      real(wp) :: energy, scale, was, force, work
      integer :: n, m
      n = model%mesh%equations
      m = size(model%support%moved, 1)
      call evaluate(model, by_secant, .false., energy, scale)
      associate (path => model%path)
         was = path%lambda_now
         force = path%lambda
         if (is_driven(model)) then
            was = path%force
            force = dot_product(model%solution%force(n + 1:n + m), model%support%moved(:, 2))
         end if
         work = 0.5_wp * (was + force) * length + dot_product(model%load%fa, path%u(0:n)) - path%constant
         yes = energy - path%stored + lost - work <= most_taken * max(path%most_stored, energy)
      end associate
   end function takes_no_energy

   !> Those of the last state
   subroutine restore_histories(model)
      type(element_model), intent(inout) :: model
      integer :: g
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            call group%restore()
         end select
      end do
   end subroutine restore_histories

   !> Newton's method with a prescribed dissipation, less and less where it does not converge
   subroutine arc_step(model, length, iterations, found, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length           !! of the control, of the first guess [J]
      integer, intent(out) :: iterations
      logical, intent(out) :: found
      integer(c_int), intent(out) :: status
      real(wp) :: ratio
      integer :: trial
      found = .false.
      status = status_ok
      iterations = 0
      associate (path => model%path)
         if (.not. path%snaps) path%energy_step = first_part * path%most_stored
         if (.not. path%energy_step > 0.0_wp) return
         ratio = 1.0_wp
         do trial = 1, most_arcs
            if (path%snaps) then
               path%u(:) = path%now + ratio * (path%now - path%before)
               path%lambda = path%lambda_now + ratio * (path%lambda_now - path%lambda_before)
            else
               call predict(model, length, status)
            end if
            path%on_arc = .true.
            if (status == status_ok) call newton_step(model, length, iterations, found, status)
            path%on_arc = .false.
            if (found) found = dissipated_by_damage(model) > least_share * path%energy_step
            if (found .or. status /= status_ok) exit
            ratio = less * ratio
            path%energy_step = less * path%energy_step
         end do
         path%snaps = found
         if (.not. found) return
         path%snaps = dot_product(model%load%fb, path%u - path%now) < 0.0_wp
         if (iterations < few) path%energy_step = min(growth * path%energy_step, most_part * path%most_stored)
      end associate
   end subroutine arc_step

   !> Energy that the damage of the present displacements takes [J]: elastic unloading to the origin takes none, within the residual
   function dissipated_by_damage(model) result(lost)
      type(element_model), intent(inout) :: model
      real(wp) :: lost
      lost = 0.0_wp
      call update_all(model, lost)
      call restore_histories(model)
   end function dissipated_by_damage

   !> Energy that the step so far dissipates where points unload to the origin [J]
   pure function dissipation(model) result(energy)
      type(element_model), intent(in) :: model
      real(wp) :: energy
      integer :: n
      n = model%mesh%equations
      associate (path => model%path, fa => model%load%fa, fb => model%load%fb)
         energy = 0.5_wp * (dot_product(fa + path%lambda_now * fb, path%u(0:n) - path%now(0:n)) - &
            (path%lambda - path%lambda_now) * dot_product(fb, path%now(0:n)))
      end associate
   end function dissipation

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
      integer :: wanted
      logical :: couples
      n = model%mesh%equations
      wanted = merge(most_entries, 0, whole)
      energy = 0.0_wp
      scale = 0.0_wp
      model%solution%force(:) = 0.0_wp
      if (whole) then
         model%stiffness%value(:) = 0.0_wp
         model%path%push(:) = 0.0_wp
         model%path%beside(:, :) = 0.0_wp
         model%path%coupled = .false.
      end if
      do g = 1, size(model%mesh%holders)
         associate (group => model%mesh%holders(g)%group, force => model%solution%force)
            do e = 1, group%elements
               call group%gather(e, model%path%u, local)
               call respond(group, e, local, how, f, k(1:wanted, 1:wanted), part)
               energy = energy + part
               do i = 1, group%freedoms
                  force(group%equation(i, e)) = force(group%equation(i, e)) + f(i) * group%factor(i, e)
                  scale = max(scale, abs(f(i)))
               end do
               if (whole) call add_symmetric(model, g, e, k)
               if (.not. (whole .and. how == by_tangent)) cycle
               select type (group)
               class is (friction_group)
                  if (.not. group%slides) cycle
                  call group%couple(e, local, k, couples)
                  model%path%coupled = model%path%coupled .or. couples
                  if (couples) call add_coupled(model, group, e, k)
               end select
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
      real(wp), intent(out) :: k(:, :)         !! none where its size is 0
      real(wp), intent(out) :: energy
      real(wp) :: own(most_entries, most_entries)
      integer :: i, n
      select type (group)
      class is (history_group)
         call group%respond(e, local, how, f, k, energy)
      class default
         n = group%freedoms
         call group%matrix(e, own)
         do i = 1, n
            f(i) = dot_product(own(i, 1:n), local(1:n))
         end do
         if (size(k) > 0) k(1:n, 1:n) = own(1:n, 1:n)
         energy = 0.5_wp * dot_product(f(1:n), local(1:n))
      end select
   end subroutine respond

   !> An element's matrix into that of the unknowns, and the forces by which moved supports act on them
   pure subroutine add_symmetric(model, g, e, k)
      type(element_model), intent(inout) :: model
      integer, intent(in) :: g, e
      real(wp), intent(in) :: k(:, :)
      integer :: i, j, n, pair, column
      n = model%mesh%equations
      pair = 0
      associate (group => model%mesh%holders(g)%group, places => model%path%places(g)%at, push => model%path%push, &
         value => model%stiffness%value)
         do j = 1, group%freedoms
            column = int(group%equation(j, e))
            if (column > n) then
               do i = 1, group%freedoms
                  push(group%equation(i, e)) = push(group%equation(i, e)) + &
                     k(i, j) * group%factor(i, e) * group%factor(j, e) * model%support%moved(column - n, 2)
               end do
            end if
            do i = j, group%freedoms
               pair = pair + 1
               if (places(pair, e) == 0) cycle
               value(places(pair, e)) = value(places(pair, e)) + k(i, j) * group%factor(i, e) * group%factor(j, e)
               ! Two freedoms of one equation: both orders
               if (i /= j .and. group%equation(i, e) == column) value(places(pair, e)) = value(places(pair, e)) + &
                  k(i, j) * group%factor(i, e) * group%factor(j, e)
            end do
         end do
      end associate
   end subroutine add_symmetric

   !> What sliding friction adds to an element's matrix, not symmetric, beside the matrix
   pure subroutine add_coupled(model, group, e, k)
      type(element_model), intent(inout) :: model
      class(element_group), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: k(:, :)
      integer :: i, j, n, row, column
      real(wp) :: value
      n = model%mesh%equations
      associate (beside => model%path%beside, push => model%path%push)
         do j = 1, group%freedoms
            column = int(group%equation(j, e))
            if (column == 0) cycle
            do i = 1, group%freedoms
               row = int(group%equation(i, e))
               if (row == 0) cycle
               value = k(i, j) * group%factor(i, e) * group%factor(j, e)
               if (column > n) then
                  push(row) = push(row) + value * model%support%moved(column - n, 2)
               else if (row <= n) then
                  associate (at => position(model%stiffness%start, model%stiffness%row, max(row, column), min(row, column)))
                     beside(at, merge(1, 2, row >= column)) = beside(at, merge(1, 2, row >= column)) + value
                  end associate
               end if
            end do
         end do
      end associate
   end subroutine add_coupled

   !> Where the pairs of an element's freedoms, by columns of the lower triangle, lie in the matrix; 0 where one is held or moved
   subroutine find_places(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: g, e, i, j, n, pair, row, column, info
      n = model%mesh%equations
      status = status_ok
      if (allocated(model%path%places)) return
      allocate (model%path%places(size(model%mesh%holders)), stat=info)
      do g = 1, merge(size(model%mesh%holders), 0, info == 0)
         associate (group => model%mesh%holders(g)%group)
            if (info == 0) allocate (model%path%places(g)%at(group%freedoms * (group%freedoms + 1) / 2, group%elements), stat=info)
            if (info /= 0) exit
            do e = 1, group%elements
               pair = 0
               do j = 1, group%freedoms
                  do i = j, group%freedoms
                     pair = pair + 1
                     row = int(max(group%equation(i, e), group%equation(j, e)))
                     column = int(min(group%equation(i, e), group%equation(j, e)))
                     model%path%places(g)%at(pair, e) = 0
                     if (column > 0 .and. row <= n) model%path%places(g)%at(pair, e) = &
                        position(model%stiffness%start, model%stiffness%row, row, column)
                  end do
               end do
            end do
         end associate
      end do
      if (info == 0) return
      if (allocated(model%path%places)) deallocate (model%path%places)
      status = status_out_of_memory
   end subroutine find_places

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
         if (status == status_ok .and. path%coupled) then
            call solve_coupled(model, z(:, 1), status)
            if (status == status_ok) call solve_coupled(model, z(:, 2), status)
         end if
         if (status /= status_ok) return
         if (is_driven(model)) then
            change = target - path%lambda
         else
            slope = dot_product(fb(1:n), z(:, 2))
            change = target - dot_product(fb, path%u(0:n)) - dot_product(fb(1:n), z(:, 1))
            if (path%on_arc) then
               associate (half => 0.5_wp * (model%load%fa + path%lambda_now * fb))
                  slope = dot_product(half(1:n), z(:, 2)) - 0.5_wp * dot_product(fb, path%now(0:n))
                  change = path%energy_step - dissipation(model) - dot_product(half(1:n), z(:, 1))
               end associate
            end if
            change = merge(change / slope, 0.0_wp, abs(slope) > 0.0_wp)
         end if
         z(:, 1) = z(:, 1) + change * z(:, 2)
         z(1, 2) = change
         if (.not. all(abs(z(:, 1)) <= unbounded)) status = status_not_positive_definite
      end associate
   end subroutine correct

   !> The solution x of (K + C) x = b with the unsymmetric part C of sliding friction, from inv(K) b: GMRES (Saad and
   !> Schultz 1986) on I + inv(K) C, which differs from the identity by as many vectors as points slide. The caller
   !> measures the residual
   subroutine solve_coupled(model, x, status)
      type(element_model), intent(in) :: model
      real(wp), intent(inout), contiguous :: x(:)      !! inv(K) b
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: basis(:, :)
      real(wp) :: h(most_krylov + 1, most_krylov), turn(2, most_krylov), right(most_krylov + 1), size_of, kept
      integer :: i, j, k, info
      allocate (basis(size(x), most_krylov + 1), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      size_of = norm2(x)
      if (.not. (size_of > 0.0_wp .and. size_of <= unbounded)) return
      right = 0.0_wp
      right(1) = size_of
      basis(:, 1) = x / size_of
      k = 0
      do j = 1, most_krylov
         call multiply_beside(model, basis(:, j), basis(:, j + 1))
         status = extrados_sparse_again(model%stiffness%factor, 1_c_int, basis(:, j + 1))
         if (status /= status_ok) return
         basis(:, j + 1) = basis(:, j + 1) + basis(:, j)
         do i = 1, j
            h(i, j) = dot_product(basis(:, i), basis(:, j + 1))
            basis(:, j + 1) = basis(:, j + 1) - h(i, j) * basis(:, i)
         end do
         h(j + 1, j) = norm2(basis(:, j + 1))
         if (h(j + 1, j) > 0.0_wp) basis(:, j + 1) = basis(:, j + 1) / h(j + 1, j)
         do i = 1, j - 1
            kept = turn(1, i) * h(i, j) + turn(2, i) * h(i + 1, j)
            h(i + 1, j) = -turn(2, i) * h(i, j) + turn(1, i) * h(i + 1, j)
            h(i, j) = kept
         end do
         kept = hypot(h(j, j), h(j + 1, j))
         if (.not. (kept > 0.0_wp .and. kept <= unbounded)) exit
         turn(:, j) = [h(j, j), h(j + 1, j)] / kept
         h(j, j) = kept
         right(j + 1) = -turn(2, j) * right(j)
         right(j) = turn(1, j) * right(j)
         k = j
         if (abs(right(j + 1)) <= krylov_tolerance * size_of) exit
      end do
      do i = k, 1, -1
         right(i) = (right(i) - dot_product(h(i, i + 1:k), right(i + 1:k))) / h(i, i)
      end do
      if (k > 0) x = matmul(basis(:, 1:k), right(1:k))
   end subroutine solve_coupled

   !> Product of what sliding friction adds to the matrix
   pure subroutine multiply_beside(model, x, y)
      type(element_model), intent(in) :: model
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      integer :: column, row
      integer(c_int64_t) :: at
      y = 0.0_wp
      associate (start => model%stiffness%start, beside => model%path%beside)
         do column = 1, size(x)
            do at = start(column) + 1, start(column + 1)
               row = int(model%stiffness%row(at)) + 1
               y(row) = y(row) + beside(at, 1) * x(column)
               y(column) = y(column) + beside(at, 2) * x(row)
            end do
         end do
      end associate
   end subroutine multiply_beside

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

   !> Newton's method by the tangent, with a line search on the residual; given up where the residual hardly decreases
   subroutine newton_step(model, length, iterations, found, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer, intent(out) :: iterations
      logical, intent(out) :: found
      integer(c_int), intent(out) :: status
      real(wp) :: energy, scale, ratio, trial, part, least
      integer :: secants, i, vain
      logical :: evaluated
      status = status_ok
      least = unbounded
      vain = 0
      secants = 0
      found = .false.
      evaluated = .false.
      do iterations = 0, most_newton
         if (.not. evaluated) call evaluate(model, merge(by_secant, by_tangent, secants > 0), .true., energy, scale)
         evaluated = .false.
         ratio = residual_of(model, scale)
         model%path%residual = ratio
         found = ratio < tolerance .and. iterations > 0
         if (model%path%on_arc) found = found .and. &
            abs(dissipation(model) - model%path%energy_step) <= arc_tolerance * model%path%energy_step
         vain = merge(0, vain + 1, ratio <= 0.5_wp * least)
         if (vain == 0) least = ratio
         if (found .or. .not. ratio <= unbounded .or. vain > most_vain) return
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
         if (model%path%on_arc) cycle     ! a search on the forces alone would leave the dissipation
         ! The whole step mostly serves: with its matrix, for the next iteration
         do i = 0, most_halvings
            call evaluate(model, merge(by_tangent, by_secant, i == 0), i == 0, energy, scale)
            trial = residual_of(model, scale)
            if (trial <= 0.9_wp * ratio .or. i == most_halvings) exit
            call move(model, -0.5_wp * part)
            part = 0.5_wp * part
         end do
         if (iterations > 0 .and. .not. trial <= 0.95_wp * ratio) secants = 3
         evaluated = i == 0 .and. secants == 0
      end do
   end subroutine newton_step

   !> Ways of decreasing potential until no force is out of balance; damage follows after each; now and then Newton's method
   !> tries to end it from the damage so far
   subroutine descent_step(model, length, iterations, found, carried, lost, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer, intent(out) :: iterations
      logical, intent(out) :: found
      logical, intent(out) :: carried
      real(wp), intent(inout) :: lost          !! [J]
      integer(c_int), intent(out) :: status
      type(pair_memory) :: pairs
      real(wp), allocatable :: before(:)
      real(wp) :: energy, scale, work, part
      integer :: n, next_try, info
      n = model%mesh%equations
      found = .false.
      carried = .true.
      next_try = first_try
      call pairs%make(n, status)
      allocate (before(n), stat=info)
      if (info /= 0) status = status_out_of_memory
      ! The state of the damage so far, which no extrapolated displacements change
      if (status == status_ok) call frozen_solution(model, length, status)
      if (status /= status_ok) return
      carried = .not. has_run_away(model, length)
      if (.not. carried) return
      call update_all(model, lost)
      associate (path => model%path, z => model%solution%z, force => model%solution%force)
         call evaluate(model, by_secant, .true., energy, scale)
         do iterations = 1, most_loops
            path%residual = residual_of(model, scale)
            found = path%residual < staggered_tolerance
            if (found) return
            if (iterations == next_try) then
               next_try = 2 * next_try
               call try_newton(model, length, found, status)
               if (found .or. status /= status_ok) return
               call evaluate(model, by_secant, .true., energy, scale)
            end if
            before(:) = force(1:n)
            call pairs%reduce(force(1:n))
            call correct(model, path%drive + length, status)
            if (status == status_not_positive_definite) then
               status = status_ok
               return
            end if
            if (status /= status_ok) return
            call pairs%complete(z(:, 1), z(1, 2))
            work = dot_product(before, z(:, 1))
            if (.not. work < 0.0_wp) then
               if (pairs%count == 0) return
               pairs%count = 0
               force(1:n) = before
               cycle
            end if
            part = 1.0_wp
            call move(model, part)
            call search_way(model, work, part, scale)
            carried = .not. has_run_away(model, length)
            if (.not. carried) return
            call update_all(model, lost)
            call pairs%take(part * z(:, 1), part * z(1, 2), force(1:n) - before, part * work)
            if (cancel_requested()) status = status_cancelled
            if (status /= status_ok) return
         end do
      end associate
   end subroutine descent_step

   !> Newton's method from the present displacements, to which it returns where it finds no state
   subroutine try_newton(model, length, found, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      logical, intent(out) :: found
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: tried(:)
      real(wp) :: lambda
      integer :: iterations, info
      found = .false.
      allocate (tried, source=model%path%u, stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      lambda = model%path%lambda
      call newton_step(model, length, iterations, found, status)
      found = found .and. .not. has_run_away(model, length)
      if (found .or. status /= status_ok) return
      model%path%u(:) = tried
      model%path%lambda = lambda
   end subroutine try_newton

   !> The part of the last correction at whose end the forces out of balance do little work along it: a longer way where
   !> they still drive it, a shorter one where they oppose it; forces and matrix are those of its end
   subroutine search_way(model, work, part, scale)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: work             !! of the forces at the start of the way [J], negative
      real(wp), intent(inout) :: part
      real(wp), intent(out) :: scale           !! largest nodal force of an element [N]
      real(wp) :: energy, now, next
      integer :: trial
      do trial = 1, most_searches
         call evaluate(model, by_secant, trial == 1, energy, scale)
         now = dot_product(model%solution%force(1:model%mesh%equations), model%solution%z(:, 1))
         if (now <= -most_opposing * work .and. (now >= most_driving * work .or. part >= longest_way)) exit
         if (now > 0.0_wp) then
            next = part * max(shorter, work / (work - now))
            if (part > 1.0_wp) next = max(1.0_wp, next)
         else if (now > work) then
            next = part * min(max(work / (work - now), longer(1)), longer(2))
         else
            next = part * longer(2)
         end if
         call move(model, next - part)
         part = next
      end do
      if (trial > 1) call evaluate(model, by_secant, .true., energy, scale)
   end subroutine search_way

   !> Damage frozen, then updated, until nothing changes; now and then Newton's method tries to end it from the damage
   !> so far
   subroutine staggered_step(model, length, iterations, found, carried, lost, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer, intent(out) :: iterations
      logical, intent(out) :: found
      logical, intent(out) :: carried
      real(wp), intent(inout) :: lost
      integer(c_int), intent(out) :: status
      real(wp) :: energy, scale, before, ratio
      integer :: next_try
      found = .false.
      carried = .true.
      next_try = first_try
      before = 0.0_wp
      do iterations = 1, most_loops
         call frozen_solution(model, length, status)
         if (status /= status_ok) return
         carried = .not. has_run_away(model, length)
         if (.not. carried) return
         call remember(model)
         call update_all(model, lost)
         call evaluate(model, by_frozen, .false., energy, scale)
         model%path%residual = residual_of(model, scale)
         found = model%path%residual < staggered_tolerance
         if (found) return
         if (iterations == next_try) then
            next_try = 2 * next_try
            call try_newton(model, length, found, status)
            if (found .or. status /= status_ok) return
         end if
         if (cancel_requested()) status = status_cancelled
         if (status /= status_ok) return
         ! Each second loop goes ahead: damage grows by a geometric series (Aitken)
         ratio = 0.0_wp
         if (before > 0.0_wp) ratio = model%path%residual / before
         before = model%path%residual
         if (ratio < slow .or. iterations < many_loops) cycle
         call go_ahead_all(model, min(most_ahead, ratio / max(1.0_wp - ratio, 0.1_wp)), lost)
         before = 0.0_wp
      end do
   end subroutine staggered_step

   !> Histories before this loop: damage may go ahead by a multiple of their growth in it
   subroutine remember(model)
      type(element_model), intent(inout) :: model
      integer :: g
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            group%before_loop(:, :) = group%history
         end select
      end do
   end subroutine remember

   !> The one equilibrium at the present damage: Newton's method on a convex energy
   subroutine frozen_solution(model, length, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: length
      integer(c_int), intent(out) :: status
      real(wp) :: energy, scale, before, slope, part, trial
      integer :: i, k, n
      logical :: evaluated
      n = model%mesh%equations
      status = status_ok
      evaluated = .false.
      do i = 0, most_inner
         if (.not. evaluated) call evaluate(model, by_frozen, .true., energy, scale)
         evaluated = .false.
         if (residual_of(model, scale) < inner_tolerance .and. i > 0) return
         before = energy - dot_product(model%load%fa, model%path%u(0:n))
         call correct(model, model%path%drive + length, status)
         if (status /= status_ok) return
         slope = dot_product(model%solution%force(1:n) + model%path%lambda * model%load%fb(1:n), model%solution%z(:, 1))
         part = 1.0_wp
         call move(model, part)
         if (i == 0) cycle          ! to the control's value
         do k = 1, 10
            call evaluate(model, by_frozen, k == 1, trial, scale)
            energy = trial
            evaluated = k == 1
            trial = trial - dot_product(model%load%fa, model%path%u(0:n))
            if (trial <= before + 1.0e-4_wp * part * slope + 1.0e-12_wp * abs(before)) exit
            call move(model, -0.5_wp * part)
            part = 0.5_wp * part
            evaluated = .false.
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

   !> Have the constant loads gone their way without the control, or displacements left it far behind?
   pure function has_run_away(model, length) result(yes)
      type(element_model), intent(in) :: model
      real(wp), intent(in) :: length
      logical :: yes
      real(wp) :: way, loads
      integer :: n
      n = model%mesh%equations
      associate (path => model%path, fa => model%load%fa)
         way = abs(path%drive + length - path%drive_start) / path%unit
         loads = sum(abs(fa(1:n)))
         yes = maxval(abs(path%u(1:n) - path%start(1:n))) > max(farthest_of_all * way, path%least_runaway)
         if (loads > 0.0_wp) yes = yes .or. dot_product(fa(1:n), path%u(1:n) - path%start(1:n)) > &
            loads * max(farthest * way, path%least_runaway)
      end associate
   end function has_run_away

   !> Do the constant loads do the work of displacements that have run away?
   pure function loads_run_away(model) result(yes)
      type(element_model), intent(in) :: model
      logical :: yes
      integer :: n
      n = model%mesh%equations
      associate (path => model%path, fa => model%load%fa)
         yes = dot_product(fa(1:n), path%u(1:n) - path%start(1:n)) > &
            share_of_loads * sum(abs(fa(1:n))) * maxval(abs(path%u(1:n) - path%start(1:n)))
      end associate
   end function loads_run_away

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

   !> All histories grow on by a multiple of their growth in the last loop
   subroutine go_ahead_all(model, ratio, lost)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: ratio
      real(wp), intent(inout) :: lost          !! [J]
      integer :: g
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (history_group)
            call group%go_ahead(model%path%u, ratio, lost)
         end select
      end do
   end subroutine go_ahead_all

end module sla_iterations
