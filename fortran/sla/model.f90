!> A finite-element model of sequentially linear analysis: groups, equations, loads, factor, displacements.
!>
!> Equations are renumbered once into the order of the factor, so that vectors need no permutation after.
module sla_model
   use common_kinds, only : wp
   use common_lists, only : sla_event_stick
   use common_status, only : status_ok, status_bad_index, status_out_of_memory, status_invalid_argument, &
      status_too_large, status_not_positive_definite
   use sla_assembly, only : build_pattern, assemble
   use sla_c_bindings, only : extrados_sparse_order, extrados_sparse_new, extrados_sparse_free, &
      extrados_sparse_factor, extrados_sparse_solve, extrados_sparse_plain
   use sla_group, only : group_holder, element_group, point_group, material_options, event_vectors, scan_result, &
      most_entries, most_rank, report_rows
   use sla_friction, only : friction_store, friction_balance, friction_follow
   use sla_turns, only : friction_turns
   use sla_regions, only : region_tree, regions_new, regions_measure, regions_settled, regions_made_up
   use sla_tables, only : tooth_tables
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t, c_ptr, c_null_ptr
   implicit none
   private
   public :: element_model, model_new, model_add, model_prepare, model_factor, model_loads, model_free, model_solve
   public :: model_displacements, model_settled, model_balance, model_reactions, model_recorded
   public :: model_follow, model_slips, model_turns, held_work, model_damage, model_standing, model_resume
   public :: standing_values

   !> Pivot ratio below which the structure counts as a mechanism
   real(wp), parameter :: least_ratio = 1.0e-13_wp
   !> No tooth or change of a stored damage has a greater number
   real(wp), parameter :: most_damage = 1.0e8_wp
   integer, parameter :: standing_values = 34   !! numbers that tell where the event loop stands

   type :: element_model
      integer :: stage = 0                               !! how far it is built, see sla_handle
      integer :: nodes = 0
      integer :: equations = 0                           !! unknown; those of moved supports come after them
      integer :: points = 0
      real(wp), allocatable :: xy(:, :)                  !! (2, nodes) in the plane, (3, nodes) in space [m]
      !> (freedoms of a node, nodes), 0 held, beyond `equations` moved: x, y; of shells x, y, z and the rotations
      integer(c_int), allocatable :: equation(:, :)
      real(wp), allocatable :: factor(:, :)              !! (freedoms of a node, nodes) share of the equation
      type(group_holder), allocatable :: holders(:)
      type(tooth_tables) :: teeth                        !! of the groups that are added next
      type(material_options) :: options
      integer(c_int64_t), allocatable :: start(:), row(:)
      real(wp), allocatable :: value(:)
      type(c_ptr) :: handle = c_null_ptr
      integer(c_int64_t) :: factor_values = 0
      type(region_tree) :: tree                          !! what an event matters to
      real(wp), allocatable :: fa(:), fb(:)              !! (0:n) constant and reference load [N]
      real(wp), allocatable :: fo(:)                     !! (0:n) forces of origins that moved, see group [N]
      real(wp), allocatable :: fh(:, :)                  !! (0:n, 2) held forces, constant and per multiplier [N]
      ! Of the last state where joints slide: displacements [m], held forces [N], energy that they take back [J]
      real(wp), allocatable :: u_before(:), f_before(:)
      real(wp) :: excess = 0.0_wp
      real(wp) :: elastic = 0.0_wp                       !! of the slip in the last state, see group [J]
      real(wp) :: held(2) = 0.0_wp                       !! fh.u of the last state [J]
      real(wp) :: origin_energy = 0.0_wp                 !! [J]
      type(friction_store) :: friction
      logical :: slides = .false.                        !! a point has slipped: no region may wait
      real(wp), allocatable :: moved(:, :)               !! (moved, 2) supports, constant and per multiplier [m]
      real(wp), allocatable :: reaction(:, :)            !! (moved, 2) their forces under A and per multiplier [N]
      integer, allocatable :: beside(:, :)               !! (2, elements) group and element at a moved support
      real(wp) :: support(2, 2) = 0.0_wp                 !! work of both reactions on both columns of `moved` [J]
      real(wp) :: support_was(2, 2) = 0.0_wp             !! of the last state
      !> (0:n + moved) displacements where the tree brought them up to date, see model_displacements [m]
      real(wp), allocatable :: ua(:), ub(:)
      real(wp), allocatable :: z(:, :)                   !! (n, 2)
      real(wp), allocatable :: force(:)                  !! (0:n) of the residual
      type(scan_result), allocatable :: part(:)          !! limits of each region
      integer, allocatable :: list(:)                    !! regions looked at in this event
      logical, allocatable :: wanted(:), watched(:)      !! regions to be brought in this event, in each event
      ! How the loop runs
      logical :: refactor = .false.                      !! factorise at each event, to compare
      integer :: threads = 1
      ! Where the loop stands
      type(event_vectors) :: event                       !! of the last event
      integer :: pending(3) = 0                          !! group, point, code not yet applied
      real(wp) :: lambda = 0.0_wp
      real(wp) :: noise = 0.0_wp                         !! stress under B that counts as none [Pa]
      real(wp) :: work(3) = 0.0_wp                       !! fa.ua, fa.ub, fb.ub of the last state [J]
      real(wp) :: work_now(3) = 0.0_wp                   !! the same with the last damage applied [J]
      real(wp) :: cross = 0.0_wp                         !! fb.ua of the last state [J]
      real(wp) :: before(most_rank) = 0.0_wp             !! w.u before the last event
      real(wp) :: external = 0.0_wp                      !! [J]
      real(wp) :: dissipated = 0.0_wp                    !! [J] along the straight way between events
      real(wp) :: cracked = 0.0_wp                       !! [J] at constant strain: the area of the teeth, never falls
      real(wp) :: first_compliance = 0.0_wp              !! fb.ub at the start of the stage
      real(wp) :: first_constant = 0.0_wp                !! work of the constant loads and supports there [J]
      real(wp) :: peak = 0.0_wp                          !! greatest |lambda| in equilibrium of the stage
      real(wp) :: peak_displacement = 0.0_wp             !! of monitor 1 there [m]
      real(wp) :: start_displacement = 0.0_wp            !! of monitor 1 under the constant loads at the start [m]
      real(wp) :: furthest = 0.0_wp                      !! its greatest way from there in the sense of the load [m]
      real(wp) :: fallen_from = huge(1.0_wp)             !! the way from which on the load is below a fraction [m]
      real(wp) :: slope = 0.0_wp                         !! of monitor 1 per unit lambda [m]
      real(wp) :: residual = 0.0_wp                      !! the last found by the guard
      integer :: guard(3) = 0                            !! residual checks, re-solutions, new factors
      integer :: events = 0
      logical :: recorded = .false.                      !! the stage has a state to count energy from
      logical :: carried = .false.                       !! the work of the constant loads is counted already
      real(wp) :: lambda_recorded = 0.0_wp               !! of the last state
      real(wp) :: scale = 1.0_wp                         !! of all loads, A too, in the state chosen; see stop_rules
      real(wp) :: scale_recorded = 1.0_wp                !! of the last state
      real(wp) :: lambda_held = 0.0_wp                   !! of the last state in equilibrium
      logical :: releasing = .false.                     !! the forces of the last tooth are being set free
      real(wp) :: released = 0.0_wp                      !! part of the way from `from` in the state chosen
      real(wp) :: free(2) = 0.0_wp                       !! there: stored energy [J], force that moves supports [N]
      real(wp), allocatable :: from(:)                   !! (0:n + moved) displacements before they are set free [m]
      integer :: hot(2, 2) = 0                           !! group and point of the last upper and lower limit
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

      model%nodes = size(xy, 2)
      model%equations = int(maxval(equation) - moved)
      model%options = options
      status = status_invalid_argument
      if (model%equations < 1 .or. minval(equation) < 0 .or. moved < 0) return
      allocate (model%xy(size(xy, 1), model%nodes), model%equation(size(equation, 1), model%nodes), &
         model%factor(size(equation, 1), model%nodes), model%holders(0), model%moved(moved, 2), &
         model%reaction(moved, 2), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      model%moved(:, :) = 0.0_wp
      model%reaction(:, :) = 0.0_wp
      model%xy(:, :) = xy
      model%equation(:, :) = equation
      model%factor(:, :) = factor
   end subroutine model_new

   !> Take a group over; freedom i of an element is freedom `of` (node, direction) or held where it is 0
   subroutine model_add(model, group, node, direction, status)
      type(element_model), intent(inout) :: model
      class(element_group), allocatable, intent(inout) :: group
      integer(c_int), intent(in) :: node(:, :)       !! (freedoms, elements), 1-based, 0 ground
      integer(c_int), intent(in) :: direction(:, :)  !! (freedoms, elements), which of its node
      integer(c_int), intent(out) :: status
      type(group_holder), allocatable :: longer(:)
      integer :: i, e, info

      status = status_bad_index
      if (any(node < 0) .or. any(node > model%nodes)) return
      if (any((direction < 1 .or. direction > size(model%equation, 1)) .and. node > 0)) return
      allocate (group%equation(group%freedoms, group%elements), group%factor(group%freedoms, group%elements), &
         longer(size(model%holders) + 1), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      do e = 1, group%elements
         do i = 1, group%freedoms
            group%equation(i, e) = 0
            group%factor(i, e) = 1.0_wp
            if (node(i, e) == 0) cycle
            group%equation(i, e) = model%equation(direction(i, e), node(i, e))
            group%factor(i, e) = model%factor(direction(i, e), node(i, e))
         end do
      end do
      group%tied = any(group%factor /= 1.0_wp)
      do i = 1, size(model%holders)
         call move_alloc(model%holders(i)%group, longer(i)%group)
      end do
      select type (group)
      class is (point_group)
         group%offset = model%points
         model%points = model%points + group%points
      end select
      call move_alloc(group, longer(size(longer))%group)
      call move_alloc(longer, model%holders)
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

      n = model%equations
      m = size(model%moved, 1)
      call build_pattern(model%holders, n, model%start, model%row, status)
      if (status /= status_ok) return
      allocate (order(n), new(0:n + m), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      status = extrados_sparse_order(int(n, c_int64_t), model%start, model%row, ordering, order)
      if (status /= status_ok) return
      new(0) = 0
      do i = 1, n
         new(order(i) + 1) = int(i, c_int)
      end do
      do i = n + 1, n + m
         new(i) = int(i, c_int)
      end do
      do i = 1, model%nodes
         do k = 1, size(model%equation, 1)
            model%equation(k, i) = new(model%equation(k, i))
         end do
      end do
      do g = 1, size(model%holders)
         associate (group => model%holders(g)%group)
            do e = 1, group%elements
               do i = 1, group%freedoms
                  group%equation(i, e) = new(group%equation(i, e))
               end do
            end do
         end associate
      end do
      call build_pattern(model%holders, n, model%start, model%row, status)
      if (status /= status_ok) return
      status = extrados_sparse_new(int(n, c_int64_t), model%start, model%row, model%handle, model%factor_values)
      if (status /= status_ok) return
      if (model%factor_values > most_values) then
         status = status_too_large
         return
      end if
      call regions_new(model%tree, model%handle, model%holders, n, status)
      ! Regions that were not measured are looked at in each event
      if (status == status_ok .and. .not. model%refactor) then
         call regions_measure(model%tree, model%holders, model%xy, model%equation, model%factor, status)
      end if
      if (status /= status_ok) return
      call find_beside(model, status)
      if (status /= status_ok) return
      allocate (model%value(model%start(n + 1)), model%fa(0:n), model%fb(0:n), model%fo(0:n + m), &
         model%fh(0:n + m, 2), model%ua(0:n + m), model%ub(0:n + m), &
         model%z(n, 2), model%force(0:n + m), model%part(size(model%tree%part)), model%list(size(model%tree%part)), &
         model%wanted(size(model%tree%part)), model%watched(size(model%tree%part)), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      model%wanted = .false.
      model%watched = .false.
      model%fa = 0.0_wp
      model%fb = 0.0_wp
      model%fo = 0.0_wp
      model%fh = 0.0_wp
      model%ua = 0.0_wp
      model%ub = 0.0_wp
   end subroutine model_prepare

   !> The elements at moved supports
   subroutine find_beside(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: g, e, count, pass, info
      status = status_ok
      do pass = 1, 2
         count = 0
         do g = 1, size(model%holders)
            associate (group => model%holders(g)%group)
               do e = 1, group%elements
                  if (.not. any(group%equation(:, e) > model%equations)) cycle
                  count = count + 1
                  if (pass == 2) model%beside(:, count) = [g, e]
               end do
            end associate
         end do
         if (pass == 2) exit
         allocate (model%beside(2, count), stat=info)
         if (info /= 0) status = status_out_of_memory
         if (info /= 0) return
      end do
   end subroutine find_beside

   !> Forces of the moved supports, and their work; the displacements beside them are up to date
   subroutine model_reactions(model)
      type(element_model), intent(inout) :: model
      real(wp) :: k(most_entries, most_entries), u(most_entries, 2), force(2)
      integer :: i, j, n, m
      n = model%equations
      m = size(model%moved, 1)
      model%reaction(:, :) = 0.0_wp
      do i = 1, size(model%beside, 2)
         associate (e => model%beside(2, i), group => model%holders(model%beside(1, i))%group)
            call group%matrix(e, k)
            call group%gather(e, model%ua, u(:, 1))
            call group%gather(e, model%ub, u(:, 2))
            do j = 1, group%freedoms
               if (group%equation(j, e) <= n) cycle
               force = matmul(k(j, 1:group%freedoms), u(1:group%freedoms, :)) * group%factor(j, e)
               model%reaction(group%equation(j, e) - n, :) = model%reaction(group%equation(j, e) - n, :) + force
            end do
         end associate
      end do
      model%reaction(:, 1) = model%reaction(:, 1) - model%fo(n + 1:n + m)
      model%reaction(:, :) = model%reaction - model%fh(n + 1:n + m, :)
      model%support = matmul(transpose(model%reaction), model%moved)
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
      call assemble(model%holders, model%start, model%row, model%value)
      status = extrados_sparse_factor(model%handle, model%value, ratio, weakest)
      if (status == status_ok .and. ratio < least_ratio) status = status_not_positive_definite
      if (status /= status_not_positive_definite) return
      do i = 1, model%nodes
         do k = 1, size(model%equation, 1)
            if (model%equation(k, i) /= weakest + 1 .or. node /= 0) cycle
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
      n = model%equations
      m = size(model%moved, 1)
      model%fo = 0.0_wp
      model%fh = 0.0_wp
      model%origin_energy = 0.0_wp
      do g = 1, size(model%holders)
         select type (group => model%holders(g)%group)
         class is (point_group)
            call group%origins(model%fo, model%fh, model%origin_energy)
         end select
      end do
      model%fo(0) = 0.0_wp
      model%fh(0, :) = 0.0_wp
      call find_slips(model)
      model%z(:, 1) = model%fa(1:n) + model%fo(1:n) + model%fh(1:n, 1)
      model%z(:, 2) = model%fb(1:n) + model%fh(1:n, 2)
      if (m > 0) call push_supports(model)
      if (model%refactor) then
         status = extrados_sparse_plain(model%handle, model%value, 2_c_int, model%z)
      else
         status = extrados_sparse_solve(model%handle, 2_c_int, model%z)
      end if
      if (status /= status_ok) return
      model%ua(1:n) = model%z(:, 1)
      model%ub(1:n) = model%z(:, 2)
      model%friction%known = .false.
      call model_balance(model, status)
   end subroutine model_solve

   !> Once a point has slipped there are forces beside the stiffness
   pure subroutine find_slips(model)
      type(element_model), intent(inout) :: model
      integer :: g
      do g = 1, size(model%holders)
         select type (group => model%holders(g)%group)
         class is (point_group)
            model%slides = model%slides .or. group%slipped()
         end select
      end do
   end subroutine find_slips

   !> The first slip: all displacements are known, those of the last state are what sliding is compared with
   subroutine model_slips(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      model%slides = .true.
      model%tree%settled = .false.
      model%friction%known = .false.
      model%held = 0.0_wp
      model%cross = dot_product(model%fb, model%ua(0:model%equations)) + model%support(2, 1)
      call model_recorded(model, model%lambda_recorded, status)
   end subroutine model_slips

   !> Where all displacements are known: let friction balance with them, then see `model_settled`
   subroutine model_balance(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status        !! not_positive_definite: what slides is a mechanism
      status = status_ok
      if (model%slides) call friction_balance(model%friction, model%holders, model%event, model%handle, &
         model%refactor, model%value, model%equations, model%ua, model%ub, model%fh, status)
      call model_settled(model)
   end subroutine model_balance

   !> Which points slide and stick so that the structure goes on, where one change after the other leads in a circle
   subroutine model_turns(model, change, found, status)
      type(element_model), intent(inout) :: model
      integer, allocatable, intent(out) :: change(:, :)    !! (3, changes) group, point, code
      logical, intent(out) :: found
      integer(c_int), intent(out) :: status
      call friction_turns(model%friction, model%holders, model%event, model%handle, model%refactor, model%value, &
         model%equations, model%lambda, model%ua, model%ub, change, found, status)
   end subroutine model_turns

   !> What sliding points do to each other, after an event without a balance
   subroutine model_follow(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      call friction_follow(model%friction, model%event, model%handle, model%refactor, model%value, model%equations, &
         status)
   end subroutine model_follow

   !> The forces by which moved supports act on the unknowns, into z; the supports move
   subroutine push_supports(model)
      type(element_model), intent(inout) :: model
      integer :: g, k, n
      n = model%equations
      model%ua(:) = 0.0_wp
      model%ub(:) = 0.0_wp
      model%ua(n + 1:) = model%moved(:, 1)
      model%ub(n + 1:) = model%moved(:, 2)
      do k = 1, 2
         model%force = 0.0_wp
         do g = 1, size(model%holders)
            if (k == 1) call model%holders(g)%group%force(model%ua, model%force)
            if (k == 2) call model%holders(g)%group%force(model%ub, model%force)
         end do
         model%z(:, k) = model%z(:, k) - model%force(1:n)
      end do
   end subroutine push_supports

   !> All displacements are known: what follows from them, and the tree takes them as its start
   subroutine model_settled(model)
      type(element_model), intent(inout) :: model
      integer :: n
      n = model%equations
      if (size(model%moved, 1) > 0) call model_reactions(model)
      model%work_now = [dot_product(model%fa, model%ua(0:n)) + model%support(1, 1), &
         dot_product(model%fa, model%ub(0:n)) + model%support(1, 2), &
         dot_product(model%fb, model%ub(0:n)) + model%support(2, 2)]
      call regions_settled(model%tree, model%ua, model%ub)
   end subroutine model_settled

   !> Displacements of the constant and the reference load as they are now
   subroutine model_displacements(model, ua, ub, status)
      type(element_model), intent(inout) :: model
      real(wp), allocatable, intent(out) :: ua(:)      !! (0:n) [m]
      real(wp), allocatable, intent(out) :: ub(:)      !! (0:n) per unit multiplier [m]
      integer(c_int), intent(out) :: status
      integer :: info
      allocate (ua, ub, mold=model%ua, stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      ua(:) = model%ua
      ub(:) = model%ub
      call regions_made_up(model%tree, model%handle, ua, ub, model%z, status)
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

      model%fa = 0.0_wp
      model%fb = 0.0_wp
      do i = 1, model%nodes
         do k = 1, size(model%equation, 1)
            q = model%equation(k, i)
            if (q > model%equations) q = 0      ! a moved support takes it
            model%fa(q) = model%fa(q) + model%factor(k, i) * load_a(k, i)
            model%fb(q) = model%fb(q) + model%factor(k, i) * load_b(k, i)
         end do
      end do
      model%fa(0) = 0.0_wp
      model%fb(0) = 0.0_wp
      if (model%refactor) call assemble(model%holders, model%start, model%row, model%value)
      model%slides = .false.
      call model_solve(model, status)
      if (status /= status_ok) return
      model%pending = 0
      model%lambda = 0.0_wp
      model%lambda_held = 0.0_wp
      model%scale = 1.0_wp
      model%scale_recorded = 1.0_wp
      model%releasing = .false.
      model%peak = 0.0_wp
      model%peak_displacement = 0.0_wp
      model%fallen_from = huge(1.0_wp)
      model%furthest = 0.0_wp
      model%event%rank = 0
      model%hot = 0
      model%residual = 0.0_wp
      model%recorded = .false.
      model%carried = carried
      model%first_compliance = model%work_now(3)
      model%first_constant = model%work_now(1)
      model%support_was = model%support

      model%noise = 0.0_wp
      allocate (zero, mold=model%ua, stat=info)
      if (info == 0) zero = 0.0_wp
      do i = 1, size(model%holders)
         if (info /= 0) exit
         select type (group => model%holders(i)%group)
         class is (point_group)
            if (allocated(values)) deallocate (values)
            allocate (values(report_rows, group%points), stat=info)
            if (info /= 0) exit
            call group%report(zero, model%ub, 1.0_wp, 0.0_wp, values)
            model%noise = max(model%noise, 1.0e-13_wp * maxval(abs(values(4:6, :))))
         end select
      end do
      if (info /= 0) status = status_out_of_memory
   end subroutine model_loads

   !> Where the event loop stands, beside the damage and the loads; to be read between two batches of events
   pure function model_standing(model) result(values)
      type(element_model), intent(in) :: model
      real(wp) :: values(standing_values)
      values = [real(model%pending, wp), model%lambda, model%noise, model%work, model%external, model%dissipated, &
         model%cracked, model%first_compliance, model%peak, model%peak_displacement, model%slope, model%residual, &
         real(model%guard, wp), real(model%events, wp), merge(1.0_wp, 0.0_wp, model%recorded), &
         merge(1.0_wp, 0.0_wp, model%carried), model%lambda_recorded, reshape(real(model%hot, wp), [4]), &
         model%scale, model%scale_recorded, model%lambda_held, model%first_constant, model%start_displacement, &
         model%fallen_from, model%furthest]
   end function model_standing

   !> Go on from where an event loop stood, after its loads and its damage were set and the factor made: the
   !> displacements are solved anew, so that all who go on from here get the same bits
   subroutine model_resume(model, values, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: values(standing_values)
      integer(c_int), intent(out) :: status      !! invalid_argument: nothing was changed
      status = status_invalid_argument
      if (.not. all(abs([values(1:3), values(17:20), values(24:27)]) <= real(huge(1), wp))) return
      if (.not. (is_point(model, nint(values(1:2))) .and. is_point(model, nint(values(24:25))) .and. &
         is_point(model, nint(values(26:27))))) return
      if (nint(values(3)) < 0 .or. nint(values(3)) > sla_event_stick) return
      model%pending = nint(values(1:3))
      model%lambda = values(4)
      model%noise = values(5)
      model%work = values(6:8)
      model%external = values(9)
      model%dissipated = values(10)
      model%cracked = values(11)
      model%first_compliance = values(12)
      model%peak = values(13)
      model%peak_displacement = values(14)
      model%slope = values(15)
      model%residual = values(16)
      model%guard = nint(values(17:19))
      model%events = nint(values(20))
      model%recorded = values(21) > 0.5_wp
      model%carried = values(22) > 0.5_wp
      model%lambda_recorded = values(23)
      model%hot = reshape(nint(values(24:27)), [2, 2])
      model%scale = values(28)
      model%scale_recorded = values(29)
      model%lambda_held = values(30)
      model%first_constant = values(31)
      model%start_displacement = values(32)
      model%fallen_from = values(33)
      model%furthest = values(34)
      model%event%rank = 0
      model%slides = .false.
      call model_solve(model, status)
      model%held = held_work(model, model%lambda_recorded)
      call model_recorded(model, model%lambda_recorded, status)
      model%cross = dot_product(model%fb, model%ua(0:model%equations)) + model%support(2, 1)
      model%support_was = model%support
   end subroutine model_resume

   !> Remember a state for the work of what slides until the next
   subroutine model_recorded(model, lambda, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: lambda
      integer(c_int), intent(out) :: status
      integer :: g, info
      status = status_ok
      model%excess = 0.0_wp
      model%elastic = 0.0_wp
      if (.not. model%slides) return
      if (.not. allocated(model%u_before)) then
         allocate (model%u_before, model%f_before, mold=model%ua, stat=info)
         if (info /= 0) status = status_out_of_memory
         if (info /= 0) return
      end if
      model%u_before(:) = model%ua + lambda * model%ub
      model%f_before(:) = model%fh(:, 1) + lambda * model%fh(:, 2)
      do g = 1, size(model%holders)
         select type (group => model%holders(g)%group)
         class is (point_group)
            model%excess = model%excess + group%excess(model%u_before)
            model%elastic = model%elastic + group%elastic(lambda, model%u_before)
         end select
      end do
   end subroutine model_recorded

   !> Products of the held forces, constant and per multiplier, with the displacements at a multiplier [J]
   pure function held_work(model, lambda) result(work)
      type(element_model), intent(in) :: model
      real(wp), intent(in) :: lambda
      real(wp) :: work(2)
      integer :: i
      do i = 1, 2
         work(i) = dot_product(model%fh(:, i), model%ua) + lambda * dot_product(model%fh(:, i), model%ub)
      end do
   end function held_work

   !> Is this the number of a group and of one of its points, or none?
   pure function is_point(model, place) result(yes)
      type(element_model), intent(in) :: model
      integer, intent(in) :: place(2)      !! group and point, the group 0: none
      logical :: yes
      yes = place(1) == 0
      if (place(1) < 1 .or. place(1) > size(model%holders)) return
      select type (group => model%holders(place(1))%group)
      class is (point_group)
         yes = place(2) >= 1 .and. place(2) <= group%points
      end select
   end function is_point

   !> Put the damage of all points into `values`, or take it from there where it can be true
   subroutine model_damage(model, store, values, status)
      type(element_model), intent(inout) :: model
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
         do g = 1, size(model%holders)
            select type (group => model%holders(g)%group)
            class is (point_group)   ! teeth count from 1
               if (any(values(4:6:2, group%offset + 1:group%offset + group%points) < 1.0_wp)) return
               if (group%directions < 2) cycle
               if (any(values(5:7:2, group%offset + 1:group%offset + group%points) < 1.0_wp)) return
            end select
         end do
      end if
      do g = 1, size(model%holders)
         select type (group => model%holders(g)%group)
         class is (point_group)
            call group%state(store, values(:, group%offset + 1:group%offset + group%points))
         end select
      end do
      status = status_ok
   end subroutine model_damage

   !> Give the factor back
   subroutine model_free(model)
      type(element_model), intent(inout) :: model
      call extrados_sparse_free(model%handle)
   end subroutine model_free

end module sla_model
