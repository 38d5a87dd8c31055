!> Sequentially linear analysis: teeth, models by handle, batches of events.
!>
!> A model lives behind a handle: create, then tables and groups (plane, bars, springs), prepare, factorise, loads,
!> run. Nodes, elements and points are 1-based.
module api_sla
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: teeth, band, intervals, body_force
   public :: create, tables, plane, bars, springs, prepare, factorise, loads, run
   public :: displacement, measure, report, damage, set_damage, standing, resume

contains

   !> Teeth of one law
   subroutine teeth(kind, e, ft, gf, h, p, exact, overshoot, room, n, modulus, strength, status)
      use sla_sawtooth, only : make_teeth
      integer(c_int), intent(in) :: kind               !! 1 linear, 2 exponential, 3 Hordijk
      real(c_double), intent(in) :: e                  !! [Pa]
      real(c_double), intent(in) :: ft                 !! [Pa]
      real(c_double), intent(in) :: gf                 !! [N/m]
      real(c_double), intent(in) :: h                  !! crack band [m]
      real(c_double), intent(in) :: p                  !! ripple half-width over ft
      integer(c_int), intent(in) :: exact              !! 1 energy-exact, 0 ripple
      integer(c_int), intent(in) :: overshoot          !! 1 first peak on the upper line, 0 at ft
      integer(c_int), intent(in) :: room
      integer(c_int), intent(out) :: n
      real(c_double), intent(out) :: modulus(room)     !! [Pa]
      real(c_double), intent(out) :: strength(room)    !! [Pa]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call make_teeth(kind, e, ft, gf, h, p, exact /= 0, overshoot /= 0, n, modulus, strength, status)
   end subroutine teeth

   !> Largest crack band without snap-back [m]
   subroutine band(kind, e, ft, gf, h)
      use sla_sawtooth, only : largest_band
      integer(c_int), intent(in) :: kind
      real(c_double), intent(in) :: e     !! [Pa]
      real(c_double), intent(in) :: ft    !! [Pa]
      real(c_double), intent(in) :: gf    !! [N/m]
      real(c_double), intent(out) :: h
      h = largest_band(kind, e, ft, gf)
   end subroutine band

   !> Admissible multipliers of n points under the criterion r <= alpha - beta m
   subroutine intervals(n, alpha, beta, a, b, lo, hi)
      use sla_interval, only : cone_interval
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: alpha      !! [Pa]
      real(c_double), intent(in) :: beta
      real(c_double), intent(in) :: a(3, n)    !! sx, sy, txy of the constant loads [Pa]
      real(c_double), intent(in) :: b(3, n)    !! per unit multiplier [Pa]
      real(c_double), intent(out) :: lo(n)     !! lo > hi: none
      real(c_double), intent(out) :: hi(n)
      integer :: k
      !f2py threadsafe
      lo = 0.0_c_double
      hi = 0.0_c_double
      do k = 1, n
         call cone_interval(alpha, beta, a(:, k), b(:, k), lo(k), hi(k))
      end do
   end subroutine intervals

   !> Nodal forces of a uniform body force in each element
   subroutine body_force(kind, nx, ny, nodes, xy, per, elements, connect, density, force, bad, status)
      use common_status, only : status_bad_index
      use sla_loads, only : distribute
      integer(c_int), intent(in) :: kind
      integer(c_int), intent(in) :: nx
      integer(c_int), intent(in) :: ny
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(in) :: xy(2, nodes)               !! [m]
      integer(c_int), intent(in) :: per                        !! nodes of an element
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(per, elements)     !! 1-based
      real(c_double), intent(in) :: density(2, elements)       !! force per area of the wall [N/m^2]
      real(c_double), intent(out) :: force(2, nodes)           !! [N]
      integer(c_int), intent(out) :: bad                       !! inverted element, 1-based
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      force = 0.0_c_double
      bad = 0
      status = status_bad_index
      if (any(connect < 1) .or. any(connect > nodes)) return
      call distribute(kind, nx, ny, xy, connect, density, force, bad, status)
   end subroutine body_force

   !> A model on nodes; equation 0 is held
   subroutine create(nodes, xy, equation, factor, isotropic, retention, closure, most_changes, floor, handle, status)
      use common_status, only : status_ok, status_out_of_memory
      use sla_group, only : material_options
      use sla_handle, only : model_register
      use sla_model, only : model, model_new
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(in) :: xy(2, nodes)          !! [m]
      integer(c_int), intent(in) :: equation(2, nodes)
      real(c_double), intent(in) :: factor(2, nodes)
      integer(c_int), intent(in) :: isotropic             !! 1: one damage for all directions
      real(c_double), intent(in) :: retention             !! negative: thesis Eq. 4.11
      integer(c_int), intent(in) :: closure               !! 1: closed cracks regain their stiffness
      integer(c_int), intent(in) :: most_changes
      real(c_double), intent(in) :: floor
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      type(material_options) :: options
      integer :: info
      handle = 0
      allocate (made, stat=info)
      status = status_out_of_memory
      if (info /= 0) return
      options%isotropic = isotropic /= 0
      options%retention = retention
      options%closure = closure /= 0
      options%most_changes = int(most_changes)
      options%floor = floor
      call model_new(xy, equation, factor, options, made, status)
      if (status == status_ok) then
         call model_register(made, handle, status)
      else
         deallocate (made)
      end if
   end subroutine create

   !> Tooth tables of the groups that are added next
   subroutine tables(handle, count, rows, bad, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_new
      use sla_model, only : model
      use sla_tables, only : tooth_tables_new
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: count
      real(c_double), intent(in) :: rows(8, count)    !! kind, E, ft, Gf, h, p, exact, overshoot; see teeth
      integer(c_int), intent(out) :: bad              !! the row that failed, 1-based
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      bad = 0
      call model_take(handle, stage_new, stage_new, made, status)
      if (status /= status_ok) return
      call tooth_tables_new(rows, made%teeth, bad, status)
      call handle_leave(handle)
   end subroutine tables

   !> Plane-stress elements of one kind
   subroutine plane(handle, kind, rule, per, elements, connect, property, choice, bad, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_new
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: kind                      !! list sla_element
      integer(c_int), intent(in) :: rule(3)                   !! Gauss points each way, 1: selective integration
      integer(c_int), intent(in) :: per                       !! nodes of an element
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(per, elements)
      !> Thickness [m], Young's modulus [Pa], Poisson's ratio, lateral strength that reduces ft [Pa] or 0,
      !> angle of the only crack normal allowed [rad]
      real(c_double), intent(in) :: property(5, elements)
      !> Table of tension teeth, of compression teeth (0 none); 1: the crack normal is given, 2: also the shear is kept
      integer(c_int), intent(in) :: choice(3, elements)
      integer(c_int), intent(out) :: bad                      !! inverted element
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      bad = 0
      call model_take(handle, stage_new, stage_new, made, status)
      if (status /= status_ok) return
      call add(status)
      call handle_leave(handle)

   contains

      subroutine add(fate)
         use common_status, only : status_bad_index, status_invalid_argument, status_out_of_memory
         use sla_group, only : element_group
         use sla_handle, only : both_directions, check_nodes
         use sla_model, only : model_add
         use sla_plane, only : plane_group, plane_group_new
         integer(c_int), intent(out) :: fate
         type(plane_group), allocatable :: made_plane
         class(element_group), allocatable :: group
         integer(c_int), allocatable :: node(:, :), direction(:, :)
         integer :: info
         call check_nodes(made, connect, 1_c_int, fate)
         if (fate /= status_ok) return
         fate = status_bad_index
         if (any(choice < 0) .or. any(choice(1:2, :) > made%teeth%tables())) return
         fate = status_invalid_argument
         if (per /= kind) return   ! the number of a kind is that of its nodes
         fate = status_out_of_memory
         allocate (made_plane, stat=info)
         if (info /= 0) return
         call plane_group_new(kind, rule(1), rule(2), rule(3) /= 0, made%xy, connect, property(1, :), property(2, :), &
            property(3, :), choice(1, :), choice(2, :), property(4, :), choice(3, :), property(5, :), made%teeth, &
            made%options, made_plane, bad, fate)
         if (fate /= status_ok) return
         call move_alloc(made_plane, group)
         call both_directions(connect, node, direction, fate)
         if (fate /= status_ok) return
         call model_add(made, group, node, direction, fate)
      end subroutine add

   end subroutine plane

   !> Bars
   subroutine bars(handle, elements, connect, property, choice, bad, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_new
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(2, elements)
      real(c_double), intent(in) :: property(2, elements)     !! area [m^2], Young's modulus [Pa]
      integer(c_int), intent(in) :: choice(2, elements)       !! table of tension teeth, of compression teeth, 0 none
      integer(c_int), intent(out) :: bad                      !! bar without length
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      bad = 0
      call model_take(handle, stage_new, stage_new, made, status)
      if (status /= status_ok) return
      call add(status)
      call handle_leave(handle)

   contains

      subroutine add(fate)
         use common_status, only : status_bad_index, status_out_of_memory
         use sla_bar, only : bar_group, bar_group_new
         use sla_group, only : element_group
         use sla_handle, only : both_directions, check_nodes
         use sla_model, only : model_add
         integer(c_int), intent(out) :: fate
         type(bar_group), allocatable :: made_bars
         class(element_group), allocatable :: group
         integer(c_int), allocatable :: node(:, :), direction(:, :)
         integer :: info
         call check_nodes(made, connect, 1_c_int, fate)
         if (fate /= status_ok) return
         fate = status_bad_index
         if (any(choice < 0) .or. any(choice > made%teeth%tables())) return
         fate = status_out_of_memory
         allocate (made_bars, stat=info)
         if (info /= 0) return
         call bar_group_new(made%xy, connect, property(1, :), property(2, :), choice(1, :), choice(2, :), made%teeth, &
            made%options, made_bars, bad, fate)
         if (fate /= status_ok) return
         call move_alloc(made_bars, group)
         call both_directions(connect, node, direction, fate)
         if (fate /= status_ok) return
         call model_add(made, group, node, direction, fate)
      end subroutine add

   end subroutine bars

   !> Linear springs between freedoms of two nodes, or of one and the ground (node 0)
   subroutine springs(handle, elements, node, direction, stiffness, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_out_of_memory
      use sla_bar, only : spring_group, spring_group_new
      use sla_group, only : element_group
      use sla_handle, only : model_take, stage_new
      use sla_model, only : model, model_add
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: node(2, elements)
      integer(c_int), intent(in) :: direction(2, elements)    !! 1 x, 2 y
      real(c_double), intent(in) :: stiffness(elements)       !! [N/m]
      integer(c_int), intent(out) :: status
      type(spring_group), allocatable :: made_springs
      class(element_group), allocatable :: group
      type(model), pointer :: made
      integer :: info
      call model_take(handle, stage_new, stage_new, made, status)
      if (status /= status_ok) return
      allocate (made_springs, stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info == 0) call spring_group_new(stiffness, made_springs, status)
      if (status == status_ok) then
         call move_alloc(made_springs, group)
         call model_add(made, group, node, direction, status)
      end if
      call handle_leave(handle)
   end subroutine springs

   !> Order and analyse; the sizes are known before the factor is allocated
   subroutine prepare(handle, ordering, most_values, refactor, threads, sizes, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_new, stage_prepared
      use sla_model, only : model, model_prepare
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: ordering             !! 0 AMD, 1 METIS
      integer(c_int64_t), intent(in) :: most_values      !! doubles the factor may take
      integer(c_int), intent(in) :: refactor             !! 1: factorise at each event
      integer(c_int), intent(in) :: threads
      integer(c_int64_t), intent(out) :: sizes(4)        !! equations, points, nonzeros of K, doubles of the factor
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      sizes = 0
      call model_take(handle, stage_new, stage_new, made, status)
      if (status /= status_ok) return
      made%refactor = refactor /= 0
      made%threads = max(1, int(threads))
      call model_prepare(made, ordering, most_values, status)
      sizes(1:2) = [int(made%equations, c_int64_t), int(made%points, c_int64_t)]
      sizes(4) = made%factor_values
      if (allocated(made%row)) sizes(3) = size(made%row, kind=c_int64_t)
      if (status == status_ok) made%stage = stage_prepared
      call handle_leave(handle)
   end subroutine prepare

   !> Assemble and factorise the present damage
   subroutine factorise(handle, node, direction, ratio, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_prepared, stage_factored, stage_loaded
      use sla_model, only : model, model_factor
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(out) :: node          !! free to move, 0 none
      integer(c_int), intent(out) :: direction     !! 1 x, 2 y
      real(c_double), intent(out) :: ratio         !! smallest over largest pivot
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      node = 0
      direction = 0
      ratio = 0.0_c_double
      call model_take(handle, stage_prepared, stage_loaded, made, status)
      if (status /= status_ok) return
      made%stage = stage_prepared
      call model_factor(made, node, direction, ratio, status)
      if (status == status_ok) made%stage = stage_factored
      call handle_leave(handle)
   end subroutine factorise

   !> Start a stage; the ledger goes on from `ledger`
   subroutine loads(handle, nodes, load_a, load_b, carried, events, ledger, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_handle, only : model_take, stage_factored, stage_loaded
      use sla_model, only : model, model_loads
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(in) :: load_a(2, nodes)    !! [N]
      real(c_double), intent(in) :: load_b(2, nodes)    !! [N]
      integer(c_int), intent(in) :: carried             !! 1: the work of A is in the ledger
      integer(c_int), intent(in) :: events              !! so far
      real(c_double), intent(in) :: ledger(3)           !! external, dissipated, crack energy so far [J]
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      call model_take(handle, stage_factored, stage_loaded, made, status)
      if (status /= status_ok) return
      if (nodes /= made%nodes .or. events < 0) then
         status = status_invalid_argument
      else
         made%events = int(events)
         made%external = ledger(1)
         made%dissipated = ledger(2)
         made%cracked = ledger(3)
         call model_loads(made, load_a, load_b, carried /= 0, status)
         if (status == status_ok) made%stage = stage_loaded
      end if
      call handle_leave(handle)
   end subroutine loads

   !> A batch of events
   subroutine run(handle, room, limits, refuse_overload, monitors, entries, first, freedom, share, &
                  counts, reals, integers, monitored, cracked, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: room
      !> Load carried, displacement of monitor 1 [m], fraction of the peak, compliance over the first; see stop_rules
      real(c_double), intent(in) :: limits(4)
      integer(c_int), intent(in) :: refuse_overload
      integer(c_int), intent(in) :: monitors
      integer(c_int), intent(in) :: entries
      integer(c_int), intent(in) :: first(monitors + 1)  !! entry at which each monitor begins
      integer(c_int), intent(in) :: freedom(2, entries)  !! node and direction (1 x, 2 y)
      real(c_double), intent(in) :: share(entries)
      !> Events, residual checks, re-solutions, new factors, reason (list sla_stop)
      integer(c_int), intent(out) :: counts(5)
      real(c_double), intent(out) :: reals(9, room)      !! see sla_events
      integer(c_int), intent(out) :: integers(4, room)
      real(c_double), intent(out) :: monitored(monitors, room)
      real(c_double), intent(out) :: cracked             !! crack energy, the last event's included [J]
      integer(c_int), intent(out) :: status              !! cancelled leaves what was recorded
      type(model), pointer :: made
      !f2py threadsafe
      reals = 0.0_c_double
      integers = 0
      monitored = 0.0_c_double
      counts = 0
      cracked = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, made, status)
      if (status /= status_ok) return
      call events(status)
      call handle_leave(handle)

   contains

      subroutine events(fate)
         use common_status, only : status_bad_index, status_out_of_memory
         use sla_events, only : run_events, stop_rules, event_log
         use sla_handle, only : check_nodes
         integer(c_int), intent(out) :: fate
         type(stop_rules) :: rules
         type(event_log) :: log
         integer(c_int), allocatable :: equation(:)
         real(c_double), allocatable :: weight(:)
         integer(c_int) :: reason
         integer :: k, info
         call check_nodes(made, freedom(1:1, :), 1_c_int, fate)
         if (fate /= status_ok) return
         fate = status_bad_index
         if (any(freedom(2, :) < 1) .or. any(freedom(2, :) > 2)) return
         if (first(1) /= 1 .or. first(monitors + 1) /= entries + 1 .or. any(first(2:) < first(:monitors))) return
         rules = stop_rules(limits(1), limits(2), limits(3), limits(4), refuse_overload /= 0)
         fate = status_out_of_memory
         allocate (equation(entries), weight(entries), log%reals(9, room), log%integers(4, room), &
            log%monitors(monitors, room), stat=info)
         if (info /= 0) return
         do k = 1, entries
            equation(k) = made%equation(freedom(2, k), freedom(1, k))
            weight(k) = share(k) * made%factor(freedom(2, k), freedom(1, k))
         end do
         call run_events(made, rules, first, equation, weight, log, reason, fate)
         counts = [int(log%count, c_int), int(made%guard, c_int), reason]
         reals(:, 1:log%count) = log%reals(:, 1:log%count)
         integers(:, 1:log%count) = log%integers(:, 1:log%count)
         monitored(:, 1:log%count) = log%monitors(:, 1:log%count)
         cracked = made%cracked
      end subroutine events

   end subroutine run

   !> Displacements of the nodes under A and under B
   subroutine displacement(handle, nodes, ua, ub, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_handle, only : model_take, stage_prepared, stage_loaded
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(out) :: ua(2, nodes)     !! [m]
      real(c_double), intent(out) :: ub(2, nodes)     !! [m]
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      integer :: i, k
      ua = 0.0_c_double
      ub = 0.0_c_double
      call model_take(handle, stage_prepared, stage_loaded, made, status)
      if (status /= status_ok) return
      if (nodes /= made%nodes) then
         status = status_invalid_argument
      else
         do i = 1, nodes
            do k = 1, 2
               ua(k, i) = made%factor(k, i) * made%ua(made%equation(k, i))
               ub(k, i) = made%factor(k, i) * made%ub(made%equation(k, i))
            end do
         end do
      end if
      call handle_leave(handle)
   end subroutine displacement

   !> Residual forces of the present displacements over the loads
   subroutine measure(handle, ratio, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_events, only : residual
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(out) :: ratio
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      ratio = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, made, status)
      if (status /= status_ok) return
      call residual(made)
      ratio = made%residual
      call handle_leave(handle)
   end subroutine measure

   !> State of all points at the multiplier lambda; rows as in sla_plane
   subroutine report(handle, lambda, points, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_group, only : point_group
      use sla_handle, only : model_take, stage_prepared, stage_loaded
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: lambda
      integer(c_int), intent(in) :: points
      real(c_double), intent(out) :: values(18, points)
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      integer :: g
      !f2py threadsafe
      values = 0.0_c_double
      call model_take(handle, stage_prepared, stage_loaded, made, status)
      if (status /= status_ok) return
      if (points /= made%points) then
         status = status_invalid_argument
      else
         do g = 1, size(made%holders)
            select type (group => made%holders(g)%group)
            class is (point_group)
               call group%report(made%ua, made%ub, lambda, made%noise, &
                  values(:, group%offset + 1:group%offset + group%points))
            end select
         end do
      end if
      call handle_leave(handle)
   end subroutine report

   !> Damage of all points, rows as in sla_group
   subroutine damage(handle, points, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_handle, only : model_take, stage_new, stage_loaded
      use sla_model, only : model, model_damage
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: points
      real(c_double), intent(out) :: values(11, points)
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      values = 0.0_c_double
      call model_take(handle, stage_new, stage_loaded, made, status)
      if (status /= status_ok) return
      if (points /= made%points) then
         status = status_invalid_argument
      else
         call model_damage(made, .true., values, status)
      end if
      call handle_leave(handle)
   end subroutine damage

   !> Set the damage of all points; the factor must be made anew
   subroutine set_damage(handle, points, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
      use sla_handle, only : model_take, stage_prepared, stage_loaded
      use sla_model, only : model, model_damage
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: values(11, points)
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      real(c_double), allocatable :: copy(:, :)
      integer :: info
      call model_take(handle, stage_prepared, stage_loaded, made, status)
      if (status /= status_ok) return
      allocate (copy(11, points), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
      else if (points /= made%points) then
         status = status_invalid_argument
      else
         copy(:, :) = values
         call model_damage(made, .false., copy, status)
         made%stage = stage_prepared
      end if
      call handle_leave(handle)
   end subroutine set_damage

   !> Read where the event loop stands; its numbers are those of sla_model
   subroutine standing(handle, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : model, model_standing
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(out) :: values(27)
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      values = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, made, status)
      if (status /= status_ok) return
      values = model_standing(made)
      call handle_leave(handle)
   end subroutine standing

   !> Go on from where an event loop stood, after its loads and damage were set and the factor was made
   subroutine resume(handle, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_factored, stage_loaded
      use sla_model, only : model, model_resume
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: values(27)
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      call model_take(handle, stage_factored, stage_loaded, made, status)
      if (status /= status_ok) return
      call model_resume(made, values, status)
      if (status == status_ok) made%stage = stage_loaded
      call handle_leave(handle)
   end subroutine resume

end module api_sla
