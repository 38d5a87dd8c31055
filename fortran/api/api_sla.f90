!> Sequentially linear analysis: teeth, models by handle, batches of events.
!>
!> A model lives between calls behind an integer handle that core.sla owns and gives back by `free`.
module api_sla
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: teeth, band, intervals, body_force
   public :: create, add_plane, add_bars, add_springs, prepare, factorise, loads, run, displacement
   public :: measure, report, damage, standing, resume
   public :: free

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
      call distribute(kind, nx, ny, xy, connect, density, force, bad, status)
   end subroutine body_force

   !> A model on nodes; equation 0 is held
   subroutine create(nodes, xy, equation, factor, isotropic, retention, closure, most_changes, floor, handle, status)
      use common_status, only : status_out_of_memory
      use sla_group, only : material_options
      use sla_model, only : model, model_new
      use sla_handle, only : handle_of
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
      handle = handle_of(made)
   end subroutine create

   !> Plane-stress elements of one kind; the tooth tables are those of the whole group
   subroutine add_plane(handle, kind, nx, ny, selective, per, elements, connect, thickness, young, nu, table, &
                        crush_table, lateral, axis, axis_angle, tables, rows, bad, bad_row, status)
      use common_status, only : status_ok, status_out_of_memory
      use sla_group, only : element_group
      use sla_handle, only : model_of, both_directions
      use sla_model, only : model, model_add
      use sla_plane, only : plane_group, plane_group_new
      use sla_tables, only : tooth_tables, tooth_tables_new
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: kind
      integer(c_int), intent(in) :: nx
      integer(c_int), intent(in) :: ny
      integer(c_int), intent(in) :: selective
      integer(c_int), intent(in) :: per                       !! nodes of an element
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(per, elements)    !! 1-based
      real(c_double), intent(in) :: thickness(elements)       !! [m]
      real(c_double), intent(in) :: young(elements)           !! [Pa]
      real(c_double), intent(in) :: nu(elements)
      integer(c_int), intent(in) :: table(elements)           !! row of tension teeth, 0 none
      integer(c_int), intent(in) :: crush_table(elements)     !! row of compression teeth, 0 none
      real(c_double), intent(in) :: lateral(elements)         !! strength that reduces ft, 0 none [Pa]
      integer(c_int), intent(in) :: axis(elements)            !! 1: one crack direction given beforehand
      real(c_double), intent(in) :: axis_angle(elements)      !! of its normal [rad]
      integer(c_int), intent(in) :: tables
      real(c_double), intent(in) :: rows(8, tables)           !! kind, E, ft, Gf, h, p, exact, overshoot
      integer(c_int), intent(out) :: bad                      !! element, 1-based
      integer(c_int), intent(out) :: bad_row                  !! table row, 1-based
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      integer :: info
      type(tooth_tables) :: teeth_of
      type(plane_group), allocatable :: plane
      class(element_group), allocatable :: group
      integer(c_int), allocatable :: node(:, :), direction(:, :)
      !f2py threadsafe
      bad = 0
      made => model_of(handle)
      call tooth_tables_new(rows, teeth_of, bad_row, status)
      if (status /= status_ok) return
      allocate (plane, stat=info)
      if (info /= 0) status = status_out_of_memory
      if (status /= status_ok) return
      call plane_group_new(kind, nx, ny, selective /= 0, made%xy, connect, thickness, young, nu, table, crush_table, &
         lateral, axis, axis_angle, teeth_of, made%options, plane, bad, status)
      if (status /= status_ok) return
      call move_alloc(plane, group)
      call both_directions(connect, node, direction, status)
      if (status /= status_ok) return
      call model_add(made, group, node, direction, status)
   end subroutine add_plane

   !> Bars
   subroutine add_bars(handle, elements, connect, area, young, table, crush_table, tables, rows, bad, bad_row, status)
      use common_status, only : status_ok, status_out_of_memory
      use sla_bar, only : bar_group, bar_group_new
      use sla_group, only : element_group
      use sla_handle, only : model_of, both_directions
      use sla_model, only : model, model_add
      use sla_tables, only : tooth_tables, tooth_tables_new
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(2, elements)      !! 1-based
      real(c_double), intent(in) :: area(elements)            !! [m^2]
      real(c_double), intent(in) :: young(elements)           !! [Pa]
      integer(c_int), intent(in) :: table(elements)
      integer(c_int), intent(in) :: crush_table(elements)
      integer(c_int), intent(in) :: tables
      real(c_double), intent(in) :: rows(8, tables)
      integer(c_int), intent(out) :: bad
      integer(c_int), intent(out) :: bad_row
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      integer :: info
      type(tooth_tables) :: teeth_of
      type(bar_group), allocatable :: bars
      class(element_group), allocatable :: group
      integer(c_int), allocatable :: node(:, :), direction(:, :)
      !f2py threadsafe
      bad = 0
      made => model_of(handle)
      call tooth_tables_new(rows, teeth_of, bad_row, status)
      if (status /= status_ok) return
      allocate (bars, stat=info)
      if (info /= 0) status = status_out_of_memory
      if (status /= status_ok) return
      call bar_group_new(made%xy, connect, area, young, table, crush_table, teeth_of, made%options, bars, bad, status)
      if (status /= status_ok) return
      call move_alloc(bars, group)
      call both_directions(connect, node, direction, status)
      if (status /= status_ok) return
      call model_add(made, group, node, direction, status)
   end subroutine add_bars

   !> Linear springs between freedoms of two nodes, or of one and the ground (node 0)
   subroutine add_springs(handle, elements, node, direction, stiffness, status)
      use common_status, only : status_ok, status_out_of_memory
      use sla_bar, only : spring_group, spring_group_new
      use sla_group, only : element_group
      use sla_handle, only : model_of
      use sla_model, only : model, model_add
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: node(2, elements)         !! 1-based
      integer(c_int), intent(in) :: direction(2, elements)    !! 1 x, 2 y
      real(c_double), intent(in) :: stiffness(elements)       !! [N/m]
      integer(c_int), intent(out) :: status
      type(spring_group), allocatable :: springs
      class(element_group), allocatable :: group
      type(model), pointer :: made
      integer :: info
      made => model_of(handle)
      allocate (springs, stat=info)
      status = status_out_of_memory
      if (info /= 0) return
      call spring_group_new(stiffness, springs, status)
      if (status /= status_ok) return
      call move_alloc(springs, group)
      call model_add(made, group, node, direction, status)
   end subroutine add_springs

   !> Order and analyse; the sizes are known before the factor is allocated
   subroutine prepare(handle, ordering, most_values, refactor, threads, sizes, status)
      use sla_handle, only : model_of
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
      made => model_of(handle)
      made%refactor = refactor /= 0
      made%threads = int(threads)
      sizes = 0
      call model_prepare(made, ordering, most_values, status)
      sizes(1:2) = [int(made%equations, c_int64_t), int(made%points, c_int64_t)]
      sizes(4) = made%factor_values
      if (allocated(made%row)) sizes(3) = size(made%row, kind=c_int64_t)
   end subroutine prepare

   !> Assemble and factorise the present damage
   subroutine factorise(handle, node, direction, ratio, status)
      use sla_handle, only : model_of
      use sla_model, only : model, model_factor
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(out) :: node          !! free to move, 1-based, 0 none
      integer(c_int), intent(out) :: direction     !! 1 x, 2 y
      real(c_double), intent(out) :: ratio         !! smallest over largest pivot
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      made => model_of(handle)
      call model_factor(made, node, direction, ratio, status)
   end subroutine factorise

   !> Start a stage; the ledger goes on from `ledger`
   subroutine loads(handle, nodes, load_a, load_b, carried, events, ledger, status)
      use sla_handle, only : model_of
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
      made => model_of(handle)
      made%events = int(events)
      made%external = ledger(1)
      made%dissipated = ledger(2)
      made%cracked = ledger(3)
      call model_loads(made, load_a, load_b, carried /= 0, status)
   end subroutine loads

   !> A batch of events
   subroutine run(handle, room, stop_lambda, stop_displacement, stop_fraction, stop_compliance, refuse_overload, &
                  monitors, entries, first, node, direction, share, count, reals, integers, monitored, guard, &
                  cracked, reason, status)
      use common_status, only : status_out_of_memory
      use sla_events, only : run_events, stop_rules, event_log
      use sla_handle, only : model_of
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: room
      real(c_double), intent(in) :: stop_lambda
      real(c_double), intent(in) :: stop_displacement    !! of monitor 1 [m]
      real(c_double), intent(in) :: stop_fraction        !! of the peak multiplier
      real(c_double), intent(in) :: stop_compliance      !! over the first
      integer(c_int), intent(in) :: refuse_overload
      integer(c_int), intent(in) :: monitors
      integer(c_int), intent(in) :: entries
      integer(c_int), intent(in) :: first(monitors + 1)  !! 1-based
      integer(c_int), intent(in) :: node(entries)        !! 1-based
      integer(c_int), intent(in) :: direction(entries)
      real(c_double), intent(in) :: share(entries)
      integer(c_int), intent(out) :: count
      real(c_double), intent(out) :: reals(9, room)      !! see sla_events
      integer(c_int), intent(out) :: integers(4, room)
      real(c_double), intent(out) :: monitored(monitors, room)
      integer(c_int), intent(out) :: guard(3)            !! residual checks, re-solutions, new factors
      real(c_double), intent(out) :: cracked             !! crack energy, the last event's included [J]
      integer(c_int), intent(out) :: reason
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      type(stop_rules) :: rules
      type(event_log) :: log
      integer(c_int), allocatable :: equation(:)
      real(c_double), allocatable :: weight(:)
      integer :: k, info
      !f2py threadsafe
      reals = 0.0_c_double
      integers = 0
      monitored = 0.0_c_double
      made => model_of(handle)
      rules%lambda = stop_lambda
      rules%displacement = stop_displacement
      rules%fraction = stop_fraction
      rules%compliance = stop_compliance
      rules%refuse_overload = refuse_overload /= 0
      allocate (equation(entries), weight(entries), log%reals(9, room), log%integers(4, room), &
         log%monitors(monitors, room), stat=info)
      count = 0
      reason = 0
      guard = 0
      cracked = 0.0_c_double
      status = status_out_of_memory
      if (info /= 0) return
      do k = 1, entries
         equation(k) = made%equation(direction(k), node(k))
         weight(k) = share(k) * made%factor(direction(k), node(k))
      end do
      call run_events(made, rules, first, equation, weight, log, reason, status)
      count = int(log%count, c_int)
      reals(:, 1:count) = log%reals(:, 1:count)
      integers(:, 1:count) = log%integers(:, 1:count)
      monitored(:, 1:count) = log%monitors(:, 1:count)
      guard = int(made%guard, c_int)
      cracked = made%cracked
   end subroutine run

   !> Displacements of the nodes under A and under B
   subroutine displacement(handle, nodes, ua, ub)
      use sla_handle, only : model_of
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(out) :: ua(2, nodes)     !! [m]
      real(c_double), intent(out) :: ub(2, nodes)     !! [m]
      type(model), pointer :: made
      integer :: i, k
      made => model_of(handle)
      do i = 1, nodes
         do k = 1, 2
            ua(k, i) = made%factor(k, i) * made%ua(made%equation(k, i))
            ub(k, i) = made%factor(k, i) * made%ub(made%equation(k, i))
         end do
      end do
   end subroutine displacement

   !> Residual forces of the present displacements over the loads
   subroutine measure(handle, ratio)
      use sla_events, only : residual
      use sla_handle, only : model_of
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(out) :: ratio
      type(model), pointer :: made
      !f2py threadsafe
      ratio = 0.0_c_double
      made => model_of(handle)
      call residual(made)
      ratio = made%residual
   end subroutine measure

   !> State of all points at the multiplier lambda; rows as in sla_plane
   subroutine report(handle, lambda, points, values)
      use sla_group, only : point_group
      use sla_handle, only : model_of
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: lambda
      integer(c_int), intent(in) :: points
      real(c_double), intent(out) :: values(18, points)
      type(model), pointer :: made
      integer :: g
      !f2py threadsafe
      values = 0.0_c_double
      made => model_of(handle)
      do g = 1, size(made%holders)
         select type (group => made%holders(g)%group)
         class is (point_group)
            call group%report(made%ua, made%ub, lambda, made%noise, &
               values(:, group%offset + 1:group%offset + group%points))
         end select
      end do
   end subroutine report

   !> Read (store = 1) or set the damage of all points; a set damage asks for a new factor
   subroutine damage(handle, store, points, given, values)
      use sla_group, only : point_group
      use sla_handle, only : model_of
      use sla_model, only : model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: store
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: given(11, points)
      real(c_double), intent(out) :: values(11, points)
      type(model), pointer :: made
      integer :: g
      values = given
      made => model_of(handle)
      do g = 1, size(made%holders)
         select type (group => made%holders(g)%group)
         class is (point_group)
            call group%state(store /= 0, values(:, group%offset + 1:group%offset + group%points))
         end select
      end do
   end subroutine damage

   !> Read where the event loop stands; its numbers are those of sla_model
   subroutine standing(handle, values)
      use sla_handle, only : model_of
      use sla_model, only : model, model_standing
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(out) :: values(27)
      type(model), pointer :: made
      made => model_of(handle)
      values = model_standing(made)
   end subroutine standing

   !> Go on from where an event loop stood, after its loads and damage were set and the factor was made
   subroutine resume(handle, values, status)
      use sla_handle, only : model_of
      use sla_model, only : model, model_resume
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: values(27)
      integer(c_int), intent(out) :: status
      type(model), pointer :: made
      !f2py threadsafe
      made => model_of(handle)
      call model_resume(made, values, status)
   end subroutine resume

   !> Give a model back; the handle becomes 0
   subroutine free(handle)
      use sla_handle, only : model_of
      use sla_model, only : model, model_free
      integer(c_int64_t), intent(in) :: handle
      type(model), pointer :: made
      made => model_of(handle)
      call model_free(made)
      deallocate (made)
   end subroutine free

end module api_sla
