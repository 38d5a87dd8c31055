!> A finite-element model of sequentially linear analysis: mesh, stiffness, loads and displacements.
!>
!> Equations are renumbered once into the order of the factor, so that vectors need no permutation after.
module sla_model
   use common_kinds, only : wp
   use common_status, only : status_ok, status_bad_index, status_out_of_memory, status_invalid_argument, &
      status_too_large, status_not_positive_definite
   use sla_assembly, only : build_pattern, assemble
   use sla_c_bindings, only : extrados_sparse_order, extrados_sparse_new, extrados_sparse_free, extrados_sparse_factor
   use sla_group, only : element_group, friction_group, material_options, most_entries, point_event, point_group, &
      group_holder, report_rows, point_place
   use sla_friction, only : friction_store, friction_balance, friction_follow
   use sla_mesh, only : element_mesh
   use sla_turns, only : friction_turns
   use sla_regions, only : regions_new, regions_measure, regions_settled, regions_made_up
   use sla_state, only : energy_ledger, equilibrium_path, force_release, limit_search, load_vectors, load_work, &
      loop_state, moved_supports, residual_checks, sliding_state, solution_vectors, stop_rules
   use sla_stiffness, only : stiffness_matrix, stiffness_solve
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: element_model, model_new, model_add, model_prepare, model_factor, model_loads, model_free, model_solve
   public :: model_displacements, model_settled, model_balance, model_reactions, model_recorded
   public :: model_follow, model_slips, model_turns, held_work, load_products, model_damage

   !> Pivot ratio below which the structure counts as a mechanism
   real(wp), parameter :: least_ratio = 1.0e-13_wp
   !> No tooth or change of a stored damage has a greater number
   real(wp), parameter :: most_damage = 1.0e8_wp

   type :: element_model
      integer :: stage = 0                 !! how far it is built, see sla_handle
      integer :: threads = 1
      type(element_mesh) :: mesh
      type(stiffness_matrix) :: stiffness
      type(load_vectors) :: load
      type(moved_supports) :: support
      type(solution_vectors) :: solution
      type(friction_store) :: friction     !! flexibilities of the joints that slide
      type(sliding_state) :: sliding
      type(limit_search) :: search
      type(loop_state) :: loop
      type(energy_ledger) :: ledger
      type(force_release) :: release
      type(residual_checks) :: checks
      type(equilibrium_path) :: path
      type(stop_rules) :: rules
   end type element_model

contains

   !> An empty model on nodes whose freedoms belong to equations
   subroutine model_new(xy, equation, moved, factor, options, model, status)
      real(wp), intent(in) :: xy(:, :)               !! (2 or 3, nodes) [m]
      integer(c_int), intent(in) :: equation(:, :)   !! (freedoms of a node, nodes), 0 held
      integer(c_int), intent(in) :: moved            !! the last equations, whose displacements are prescribed
      real(wp), intent(in) :: factor(:, :)           !! (freedoms of a node, nodes)
      type(material_options), intent(in) :: options
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: info

      associate (mesh => model%mesh, support => model%support)
         mesh%nodes = size(xy, 2)
         mesh%equations = int(maxval(equation) - moved)
         mesh%options = options
         status = status_invalid_argument
         if (mesh%equations < 1 .or. minval(equation) < 0 .or. moved < 0) return
         allocate (mesh%xy(size(xy, 1), mesh%nodes), mesh%equation(size(equation, 1), mesh%nodes), &
            mesh%factor(size(equation, 1), mesh%nodes), mesh%holders(0), support%moved(moved, 2), &
            support%reaction(moved, 2), stat=info)
         status = merge(status_ok, status_out_of_memory, info == 0)
         if (info /= 0) return
         support%moved(:, :) = 0.0_wp
         support%reaction(:, :) = 0.0_wp
         mesh%xy(:, :) = xy
         mesh%equation(:, :) = equation
         mesh%factor(:, :) = factor
      end associate
   end subroutine model_new

   !> Take a group over; freedom i of an element is freedom `of` (node, direction) or held where it is 0
   subroutine model_add(mesh, group, node, direction, status)
      type(element_mesh), intent(inout) :: mesh
      class(element_group), allocatable, intent(inout) :: group
      integer(c_int), intent(in) :: node(:, :)       !! (freedoms, elements), 1-based, 0 ground
      integer(c_int), intent(in) :: direction(:, :)  !! (freedoms, elements), which of its node
      integer(c_int), intent(out) :: status
      type(group_holder), allocatable :: longer(:)
      integer :: i, e, info

      status = status_bad_index
      if (any(node < 0) .or. any(node > mesh%nodes)) return
      if (any((direction < 1 .or. direction > size(mesh%equation, 1)) .and. node > 0)) return
      allocate (group%equation(group%freedoms, group%elements), group%factor(group%freedoms, group%elements), &
         longer(size(mesh%holders) + 1), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      do e = 1, group%elements
         do i = 1, group%freedoms
            group%equation(i, e) = 0
            group%factor(i, e) = 1.0_wp
            if (node(i, e) == 0) cycle
            group%equation(i, e) = mesh%equation(direction(i, e), node(i, e))
            group%factor(i, e) = mesh%factor(direction(i, e), node(i, e))
         end do
      end do
      group%tied = any(group%factor /= 1.0_wp)
      do i = 1, size(mesh%holders)
         call move_alloc(mesh%holders(i)%group, longer(i)%group)
      end do
      select type (group)
      class is (point_group)
         group%offset = mesh%points
         mesh%points = mesh%points + group%points
      end select
      call move_alloc(group, longer(size(longer))%group)
      call move_alloc(longer, mesh%holders)
      status = status_ok
   end subroutine model_add

   !> Order the equations, fix the pattern, allocate
   subroutine model_prepare(model, ordering, most_values, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(in) :: ordering           !! 0 AMD, 1 METIS
      integer(c_int64_t), intent(in) :: most_values    !! doubles the factor may take
      integer(c_int), intent(out) :: status
      integer(c_int64_t), allocatable :: order(:)
      integer(c_int), allocatable :: new(:)
      integer :: n, m, i, k, e, g, info

      n = model%mesh%equations
      m = size(model%support%moved, 1)
      associate (mesh => model%mesh, stiffness => model%stiffness, tree => model%search%tree)
         call build_pattern(mesh%holders, n, stiffness%start, stiffness%row, status)
         if (status /= status_ok) return
         allocate (order(n), new(0:n + m), stat=info)
         if (info /= 0) then
            status = status_out_of_memory
            return
         end if
         status = extrados_sparse_order(int(n, c_int64_t), stiffness%start, stiffness%row, ordering, order)
         if (status /= status_ok) return
         new(0) = 0
         do i = 1, n
            new(order(i) + 1) = int(i, c_int)
         end do
         do i = n + 1, n + m
            new(i) = int(i, c_int)
         end do
         do i = 1, mesh%nodes
            do k = 1, size(mesh%equation, 1)
               mesh%equation(k, i) = new(mesh%equation(k, i))
            end do
         end do
         do g = 1, size(mesh%holders)
            associate (group => mesh%holders(g)%group)
               do e = 1, group%elements
                  do i = 1, group%freedoms
                     group%equation(i, e) = new(group%equation(i, e))
                  end do
               end do
            end associate
         end do
         call build_pattern(mesh%holders, n, stiffness%start, stiffness%row, status)
         if (status /= status_ok) return
         status = extrados_sparse_new(int(n, c_int64_t), stiffness%start, stiffness%row, stiffness%factor, &
            stiffness%factor_values)
         if (status /= status_ok) return
         if (stiffness%factor_values > most_values) then
            status = status_too_large
            return
         end if
         call regions_new(tree, stiffness%factor, mesh%holders, n, status)
         ! Regions that were not measured are looked at in each event
         if (status == status_ok .and. .not. stiffness%refactor) call regions_measure(tree, mesh%holders, mesh%xy, &
            mesh%equation, mesh%factor, status)
      end associate
      if (status == status_ok) call find_beside(model, status)
      if (status == status_ok) call allocate_vectors(model, status)
   end subroutine model_prepare

   !> Loads, displacements and limits of a model whose regions are known, all zero
   subroutine allocate_vectors(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: n, m, regions, info

      n = model%mesh%equations
      m = size(model%support%moved, 1)
      regions = size(model%search%tree%part)
      associate (load => model%load, solution => model%solution, search => model%search)
         allocate (model%stiffness%value(model%stiffness%start(n + 1)), load%fa(0:n), load%fb(0:n), load%fo(0:n + m), &
            load%fh(0:n + m, 2), solution%ua(0:n + m), solution%ub(0:n + m), solution%z(n, 2), &
            solution%force(0:n + m), search%part(regions), search%list(regions), search%wanted(regions), &
            search%watched(regions), stat=info)
         status = merge(status_ok, status_out_of_memory, info == 0)
         if (info /= 0) return
         search%wanted = .false.
         search%watched = .false.
         load%fa = 0.0_wp
         load%fb = 0.0_wp
         load%fo = 0.0_wp
         load%fh = 0.0_wp
         solution%ua = 0.0_wp
         solution%ub = 0.0_wp
      end associate
   end subroutine allocate_vectors

   !> The elements at moved supports
   subroutine find_beside(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: g, e, count, pass, info
      status = status_ok
      do pass = 1, 2
         count = 0
         do g = 1, size(model%mesh%holders)
            associate (group => model%mesh%holders(g)%group)
               do e = 1, group%elements
                  if (.not. any(group%equation(:, e) > model%mesh%equations)) cycle
                  count = count + 1
                  if (pass == 2) model%support%beside(:, count) = [g, e]
               end do
            end associate
         end do
         if (pass == 2) exit
         allocate (model%support%beside(2, count), stat=info)
         if (info /= 0) status = status_out_of_memory
         if (info /= 0) return
      end do
   end subroutine find_beside

   !> Forces of the moved supports, and their work; the displacements beside them are up to date
   subroutine model_reactions(model)
      type(element_model), intent(inout) :: model
      real(wp) :: k(most_entries, most_entries), u(most_entries, 2), force(2), work(2, 2)
      integer :: i, j, n, m
      n = model%mesh%equations
      m = size(model%support%moved, 1)
      model%support%reaction(:, :) = 0.0_wp
      do i = 1, size(model%support%beside, 2)
         associate (e => model%support%beside(2, i), group => model%mesh%holders(model%support%beside(1, i))%group)
            call group%matrix(e, k)
            call group%gather(e, model%solution%ua, u(:, 1))
            call group%gather(e, model%solution%ub, u(:, 2))
            do j = 1, group%freedoms
               if (group%equation(j, e) <= n) cycle
               force = matmul(k(j, 1:group%freedoms), u(1:group%freedoms, :)) * group%factor(j, e)
               associate (reaction => model%support%reaction(group%equation(j, e) - n, :))
                  reaction = reaction + force
               end associate
            end do
         end associate
      end do
      model%support%reaction(:, 1) = model%support%reaction(:, 1) - model%load%fo(n + 1:n + m)
      model%support%reaction(:, :) = model%support%reaction - model%load%fh(n + 1:n + m, :)
      work = matmul(transpose(model%support%reaction), model%support%moved)
      model%support%work = load_work(work(1, 1), work(1, 2), work(2, 1), work(2, 2))
   end subroutine model_reactions

   !> Assemble and factorise; names the node that is free to move
   subroutine model_factor(model, node, direction, ratio, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: node        !! 1-based, 0 none
      integer(c_int), intent(out) :: direction   !! which of its freedoms
      real(wp), intent(out) :: ratio             !! smallest over largest pivot
      integer(c_int), intent(out) :: status
      integer(c_int64_t) :: weakest
      integer :: i, k

      node = 0
      direction = 0
      call assemble(model%mesh%holders, model%stiffness%start, model%stiffness%row, model%stiffness%value)
      status = extrados_sparse_factor(model%stiffness%factor, model%stiffness%value, ratio, weakest)
      if (status == status_ok .and. ratio < least_ratio) status = status_not_positive_definite
      if (status /= status_not_positive_definite) return
      do i = 1, model%mesh%nodes
         do k = 1, size(model%mesh%equation, 1)
            if (model%mesh%equation(k, i) /= weakest + 1 .or. node /= 0) cycle
            node = int(i, c_int)
            direction = int(k, c_int)
         end do
      end do
   end subroutine model_factor

   !> Displacements of the constant and the reference load by the factor in use
   subroutine model_solve(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: n, g, m
      n = model%mesh%equations
      m = size(model%support%moved, 1)
      associate (load => model%load, z => model%solution%z)
         load%fo = 0.0_wp
         load%fh = 0.0_wp
         model%sliding%origin_energy = 0.0_wp
         do g = 1, size(model%mesh%holders)
            select type (group => model%mesh%holders(g)%group)
            class is (friction_group)
               call group%origins(load%fo, load%fh, model%sliding%origin_energy)
            end select
         end do
         load%fo(0) = 0.0_wp
         load%fh(0, :) = 0.0_wp
         call find_slips(model)
         z(:, 1) = load%fa(1:n) + load%fo(1:n) + load%fh(1:n, 1)
         z(:, 2) = load%fb(1:n) + load%fh(1:n, 2)
         if (m > 0) call push_supports(model)
         call stiffness_solve(model%stiffness, z, status)
         if (status /= status_ok) return
         model%solution%ua(1:n) = z(:, 1)
         model%solution%ub(1:n) = z(:, 2)
      end associate
      model%friction%known = .false.
      call model_balance(model, status)
   end subroutine model_solve

   !> Once a point has slipped there are forces beside the stiffness
   pure subroutine find_slips(model)
      type(element_model), intent(inout) :: model
      integer :: g
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (friction_group)
            model%sliding%active = model%sliding%active .or. group%slipped()
         end select
      end do
   end subroutine find_slips

   !> The first slip: all displacements are known, those of the last state are what sliding is compared with
   subroutine model_slips(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      type(load_work) :: work
      model%sliding%active = .true.
      model%search%tree%settled = .false.
      model%friction%known = .false.
      model%sliding%held = 0.0_wp
      work = load_products(model)
      model%ledger%work%ba = work%ba
      call model_recorded(model, model%ledger%lambda, status)
   end subroutine model_slips

   !> Where all displacements are known: let friction balance with them, then see `model_settled`
   subroutine model_balance(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status        !! not_positive_definite: what slides is a mechanism
      status = status_ok
      if (model%sliding%active) call friction_balance(model%friction, model%mesh%holders, model%loop%event, &
         model%stiffness, model%solution%ua, model%solution%ub, model%load%fh, status)
      call model_settled(model)
   end subroutine model_balance

   !> Which points slide and stick so that the structure goes on, where one change after the other leads in a circle
   subroutine model_turns(model, change, found, status)
      type(element_model), intent(inout) :: model
      type(point_event), allocatable, intent(out) :: change(:)
      logical, intent(out) :: found
      integer(c_int), intent(out) :: status
      call friction_turns(model%friction, model%mesh%holders, model%loop%event, model%stiffness, &
         model%loop%lambda, model%solution%ua, model%solution%ub, change, found, status)
   end subroutine model_turns

   !> What sliding points do to each other, after an event without a balance
   subroutine model_follow(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      call friction_follow(model%friction, model%loop%event, model%stiffness, status)
   end subroutine model_follow

   !> The forces by which moved supports act on the unknowns, into z; the supports move
   subroutine push_supports(model)
      type(element_model), intent(inout) :: model
      integer :: g, k, n
      n = model%mesh%equations
      model%solution%ua(:) = 0.0_wp
      model%solution%ub(:) = 0.0_wp
      model%solution%ua(n + 1:) = model%support%moved(:, 1)
      model%solution%ub(n + 1:) = model%support%moved(:, 2)
      do k = 1, 2
         model%solution%force = 0.0_wp
         do g = 1, size(model%mesh%holders)
            if (k == 1) call model%mesh%holders(g)%group%force(model%solution%ua, model%solution%force)
            if (k == 2) call model%mesh%holders(g)%group%force(model%solution%ub, model%solution%force)
         end do
         model%solution%z(:, k) = model%solution%z(:, k) - model%solution%force(1:n)
      end do
   end subroutine push_supports

   !> Products of the loads, with the reactions, and the displacements, all of which are known
   pure function load_products(model) result(work)
      type(element_model), intent(in) :: model
      type(load_work) :: work
      integer :: n
      n = model%mesh%equations
      associate (fa => model%load%fa, fb => model%load%fb, ua => model%solution%ua, ub => model%solution%ub, &
         support => model%support%work)
         work = load_work(dot_product(fa, ua(0:n)) + support%aa, dot_product(fa, ub(0:n)) + support%ab, &
            dot_product(fb, ua(0:n)) + support%ba, dot_product(fb, ub(0:n)) + support%bb)
      end associate
   end function load_products

   !> All displacements are known: what follows from them, and the tree takes them as its start
   subroutine model_settled(model)
      type(element_model), intent(inout) :: model
      if (size(model%support%moved, 1) > 0) call model_reactions(model)
      model%solution%work = load_products(model)
      model%solution%work%ba = model%solution%work%ab
      call regions_settled(model%search%tree, model%solution%ua, model%solution%ub)
   end subroutine model_settled

   !> Displacements of the constant and the reference load as they are now
   subroutine model_displacements(model, ua, ub, status)
      type(element_model), intent(inout) :: model
      real(wp), allocatable, intent(out) :: ua(:)      !! (0:n) [m]
      real(wp), allocatable, intent(out) :: ub(:)      !! (0:n) per unit multiplier [m]
      integer(c_int), intent(out) :: status
      integer :: info
      allocate (ua, ub, mold=model%solution%ua, stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      ua(:) = model%solution%ua
      ub(:) = model%solution%ub
      call regions_made_up(model%search%tree, model%stiffness%factor, ua, ub, model%solution%z, status)
   end subroutine model_displacements

   !> Start a stage: constant load A and reference load B as nodal forces
   subroutine model_loads(model, load_a, load_b, carried, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: load_a(:, :)     !! (freedoms of a node, nodes) [N], [N m]
      real(wp), intent(in) :: load_b(:, :)     !! (freedoms of a node, nodes) [N], [N m]
      logical, intent(in) :: carried           !! the stage before ended under these constant loads
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: values(:, :), zero(:)
      integer :: i, k, q, info

      associate (mesh => model%mesh, fa => model%load%fa, fb => model%load%fb)
         fa = 0.0_wp
         fb = 0.0_wp
         do i = 1, mesh%nodes
            do k = 1, size(mesh%equation, 1)
               q = mesh%equation(k, i)
               if (q > mesh%equations) q = 0      ! a moved support takes it
               fa(q) = fa(q) + mesh%factor(k, i) * load_a(k, i)
               fb(q) = fb(q) + mesh%factor(k, i) * load_b(k, i)
            end do
         end do
         fa(0) = 0.0_wp
         fb(0) = 0.0_wp
      end associate
      if (model%stiffness%refactor) call assemble(model%mesh%holders, model%stiffness%start, model%stiffness%row, &
         model%stiffness%value)
      model%sliding%active = .false.
      call model_solve(model, status)
      if (status /= status_ok) return
      model%loop = loop_state(events=model%loop%events, first_compliance=model%solution%work%bb, &
         first_constant=model%solution%work%aa)
      model%search%upper = point_place()
      model%search%lower = point_place()
      model%release%active = .false.
      model%path%active = .false.
      model%checks%residual = 0.0_wp
      model%ledger%scale = 1.0_wp
      model%ledger%recorded = .false.
      model%ledger%carried = carried
      model%ledger%support_work = model%support%work

      model%search%noise = 0.0_wp
      allocate (zero, mold=model%solution%ua, stat=info)
      if (info == 0) zero = 0.0_wp
      do i = 1, size(model%mesh%holders)
         if (info /= 0) exit
         select type (group => model%mesh%holders(i)%group)
         class is (point_group)
            if (allocated(values)) deallocate (values)
            allocate (values(report_rows, group%points), stat=info)
            if (info /= 0) exit
            call group%report(zero, model%solution%ub, 1.0_wp, 0.0_wp, values)
            model%search%noise = max(model%search%noise, 1.0e-13_wp * maxval(abs(values(4:6, :))))
         end select
      end do
      if (info /= 0) status = status_out_of_memory
   end subroutine model_loads

   !> Remember a state for the work of what slides until the next
   subroutine model_recorded(model, lambda, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: lambda
      integer(c_int), intent(out) :: status
      integer :: g, info
      status = status_ok
      associate (sliding => model%sliding, load => model%load, solution => model%solution)
         sliding%excess = 0.0_wp
         sliding%elastic = 0.0_wp
         if (.not. sliding%active) return
         if (.not. allocated(sliding%u_before)) then
            allocate (sliding%u_before, sliding%f_before, mold=solution%ua, stat=info)
            if (info /= 0) status = status_out_of_memory
            if (info /= 0) return
         end if
         sliding%u_before(:) = solution%ua + lambda * solution%ub
         sliding%f_before(:) = load%fh(:, 1) + lambda * load%fh(:, 2)
         do g = 1, size(model%mesh%holders)
            select type (group => model%mesh%holders(g)%group)
            class is (friction_group)
               sliding%excess = sliding%excess + group%excess(sliding%u_before)
               sliding%elastic = sliding%elastic + group%elastic(lambda, sliding%u_before)
            end select
         end do
      end associate
   end subroutine model_recorded

   !> Products of the held forces, constant and per multiplier, with the displacements at a multiplier [J]
   pure function held_work(model, lambda) result(work)
      type(element_model), intent(in) :: model
      real(wp), intent(in) :: lambda
      real(wp) :: work(2)
      integer :: i
      associate (fh => model%load%fh, ua => model%solution%ua, ub => model%solution%ub)
         do i = 1, 2
            work(i) = dot_product(fh(:, i), ua) + lambda * dot_product(fh(:, i), ub)
         end do
      end associate
   end function held_work

   !> Put the damage of all points into `values`, or take it from there where it can be true
   subroutine model_damage(mesh, store, values, status)
      type(element_mesh), intent(inout) :: mesh
      logical, intent(in) :: store
      real(wp), intent(inout) :: values(:, :)        !! (state_rows, points)
      integer(c_int), intent(out) :: status          !! invalid_argument: nothing was changed
      integer :: g
      status = status_invalid_argument
      if (.not. store) then
         if (.not. all(abs(values) <= most_damage)) return
         ! Rows 7 and 9 are those of a second direction, and lengths of joints
         if (any(values([4, 5, 6, 8, 10, 11], :) < 0.0_wp)) return
         if (any(abs(values([3, 4, 5, 6, 8], :) - anint(values([3, 4, 5, 6, 8], :))) > 0.0_wp)) return
         if (any(abs(values(10:11, :) - anint(values(10:11, :))) > 0.0_wp)) return
         do g = 1, size(mesh%holders)
            select type (group => mesh%holders(g)%group)
            class is (point_group)   ! teeth count from 1
               if (any(values(4:6:2, group%offset + 1:group%offset + group%points) < 1.0_wp)) return
               if (group%directions < 2) cycle
               if (any(values(5:7:2, group%offset + 1:group%offset + group%points) < 1.0_wp)) return
            end select
         end do
      end if
      do g = 1, size(mesh%holders)
         select type (group => mesh%holders(g)%group)
         class is (point_group)
            call group%state(store, values(:, group%offset + 1:group%offset + group%points))
         end select
      end do
      status = status_ok
   end subroutine model_damage

   !> Give the factor back
   subroutine model_free(model)
      type(element_model), intent(inout) :: model
      call extrados_sparse_free(model%stiffness%factor)
   end subroutine model_free

end module sla_model
