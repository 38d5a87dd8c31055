!> Sequentially linear analysis: a model built in steps behind a handle.
!>
!> Create, then tables and groups (plane, bars, springs), prepare, factorise; api_sla loads it and runs its events.
!> Nodes, elements and points are 1-based.
module api_sla_model
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: body_force, create, tables, plane, bars, springs, prepare, factorise

contains

   !> Nodal forces of a uniform body force in each element
   subroutine body_force(kind, nx, ny, nodes, xy, per, elements, connect, density, force, bad, status)
      use common_status, only : status_bad_index
      use sla_loads, only : distribute_force
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
      call distribute_force(kind, nx, ny, xy, connect, density, force, bad, status)
   end subroutine body_force

   !> A model on nodes; equation 0 is held, the last `moved` are those of supports that move
   subroutine create(axes, freedoms, nodes, xy, equation, moved, factor, cracking, retention, closure, most_changes, &
                     floor, extent, handle, status)
      use common_status, only : status_ok, status_out_of_memory
      use sla_group, only : material_options
      use sla_handle, only : model_register
      use sla_model, only : element_model, model_new
      integer(c_int), intent(in) :: axes                  !! 2 in the plane, 3 in space
      integer(c_int), intent(in) :: freedoms              !! of a node: 2, of shells 6
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(in) :: xy(axes, nodes)       !! [m]
      integer(c_int), intent(in) :: equation(freedoms, nodes)
      integer(c_int), intent(in) :: moved
      real(c_double), intent(in) :: factor(freedoms, nodes)
      integer(c_int), intent(in) :: cracking              !! of the list sla_cracking
      real(c_double), intent(in) :: retention             !! negative: thesis Eq. 4.11
      integer(c_int), intent(in) :: closure               !! 1: closed cracks regain their stiffness
      integer(c_int), intent(in) :: most_changes
      real(c_double), intent(in) :: floor
      integer(c_int), intent(in) :: extent                !! 1: crack bands are extents across the crack
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      type(material_options) :: options
      integer :: info
      handle = 0
      allocate (model, stat=info)
      status = status_out_of_memory
      if (info /= 0) return
      options%cracking = cracking
      options%retention = retention
      options%closure = closure /= 0
      options%most_changes = int(most_changes)
      options%floor = floor
      options%extent = extent /= 0
      call model_new(xy, equation, moved, factor, options, model, status)
      if (status == status_ok) then
         call model_register(model, handle, status)
      else
         deallocate (model)
      end if
   end subroutine create

   !> Tooth tables of the groups that are added next
   subroutine tables(handle, count, rows, bad, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_new
      use sla_model, only : element_model
      use sla_tables, only : tooth_tables_new
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: count
      real(c_double), intent(in) :: rows(8, count)    !! kind, E, ft, Gf, h, p, exact, overshoot; see teeth
      integer(c_int), intent(out) :: bad              !! the row that failed, 1-based
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      !f2py threadsafe
      bad = 0
      call model_take(handle, stage_new, stage_new, model, status)
      if (status /= status_ok) return
      call tooth_tables_new(rows, model%mesh%teeth, bad, status)
      call handle_leave(handle)
   end subroutine tables

   !> Plane-stress elements of one kind
   subroutine plane(handle, kind, rule, per, elements, connect, property, choice, bad, status)
      use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_out_of_memory
      use sla_group, only : element_group
      use sla_handle, only : group_added, group_begun
      use sla_model, only : element_model
      use sla_plane, only : plane_group, plane_group_new
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: kind                      !! list sla_element
      integer(c_int), intent(in) :: rule(3)                   !! Gauss points each way, 1: selective integration
      integer(c_int), intent(in) :: per                       !! nodes of an element
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(per, elements)
      !> Thickness [m], Young's modulus [Pa], Poisson's ratio, lateral strength that reduces ft [Pa] or 0,
      !> angle of the only crack normal allowed [rad], growth of the compressive strength per lateral pressure;
      !> angle of the bed joints [rad], tensile strength (0: none is bedded) and fracture energy along over across them,
      !> shear factor, crack band or 0, compressive strength along over across them (0: one for all), its b and c, see
      !> sla_bedding
      real(c_double), intent(in) :: property(14, elements)
      !> Table of tension teeth (0 none), first and last of them where the crack band follows the direction of the crack
      !> (0 where not); table of compression teeth; 1: the crack normal is given, 2: also the shear is kept
      integer(c_int), intent(in) :: choice(5, elements)
      integer(c_int), intent(out) :: bad                      !! inverted element
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      type(plane_group), allocatable :: new_plane
      class(element_group), allocatable :: group
      integer :: info
      !f2py threadsafe
      bad = 0
      call group_begun(handle, connect, choice(1:4, :), model, status)
      if (status /= status_ok) return
      allocate (new_plane, stat=info)
      if (any(choice(5, :) < 0)) then
         status = status_bad_index
      else if (any(choice(2, :) > choice(3, :)) .or. per /= kind .or. &
               any(property(8, :) > 0.0_c_double .and. choice(1, :) > 0 .and. choice(2, :) == 0)) then
         status = status_invalid_argument   ! the number of a kind is that of its nodes
      else if (size(model%mesh%xy, 1) /= 2) then
         status = status_invalid_argument   ! shells are for the space
      else if (info /= 0) then
         status = status_out_of_memory
      else
         call plane_group_new(kind, rule(1), rule(2), rule(3) /= 0, model%mesh%xy, connect, property, choice, &
            model%mesh%teeth, model%mesh%options, new_plane, bad, status)
      end if
      call move_alloc(new_plane, group)
      call group_added(handle, model, connect, 2, group, status)
   end subroutine plane

   !> Bars by the strain that the displacements of their nodes make
   subroutine bars(handle, ways, per, elements, connect, gradient, property, choice, bad, status)
      use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
      use sla_bar, only : bar_group, bar_group_new
      use sla_group, only : element_group, most_entries
      use sla_handle, only : group_added, group_begun
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: ways                          !! directions of a node, 2 or in space 3
      integer(c_int), intent(in) :: per                           !! nodes of a bar
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(per, elements)
      real(c_double), intent(in) :: gradient(ways, per, elements) !! strain per displacement in x, y and z [1/m]
      real(c_double), intent(in) :: property(2, elements)         !! volume [m^3], Young's modulus [Pa]
      !> Table of tension teeth, of compression teeth, 0 none; 0 carries both, 1 tension, 2 pressure alone
      integer(c_int), intent(in) :: choice(3, elements)
      integer(c_int), intent(out) :: bad                          !! bar without length
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      type(bar_group), allocatable :: new_bars
      class(element_group), allocatable :: group
      integer :: info
      !f2py threadsafe
      bad = 0
      call group_begun(handle, connect, choice(1:2, :), model, status)
      if (status /= status_ok) return
      allocate (new_bars, stat=info)
      if (any(choice(3, :) < 0) .or. any(choice(3, :) > 2) .or. ways * per > most_entries .or. &
          ways /= size(model%mesh%xy, 1)) then
         status = status_invalid_argument
      else if (info /= 0) then
         status = status_out_of_memory
      else
         call bar_group_new(gradient, property(1, :), property(2, :), choice(1, :), choice(2, :), choice(3, :), &
            model%mesh%teeth, model%mesh%options, new_bars, bad, status)
      end if
      call move_alloc(new_bars, group)
      call group_added(handle, model, connect, int(ways), group, status)
   end subroutine bars

   !> Linear springs between freedoms of two nodes, or of one and the ground (node 0)
   subroutine springs(handle, elements, node, direction, stiffness, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_out_of_memory
      use sla_bar, only : spring_group, spring_group_new
      use sla_group, only : element_group
      use sla_handle, only : model_take, stage_new
      use sla_model, only : element_model, model_add
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: node(2, elements)
      integer(c_int), intent(in) :: direction(2, elements)    !! which freedoms of the nodes
      real(c_double), intent(in) :: stiffness(elements)       !! [N/m]
      integer(c_int), intent(out) :: status
      type(spring_group), allocatable :: new_springs
      class(element_group), allocatable :: group
      type(element_model), pointer :: model
      integer :: info
      call model_take(handle, stage_new, stage_new, model, status)
      if (status /= status_ok) return
      allocate (new_springs, stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info == 0) call spring_group_new(stiffness, new_springs, status)
      if (status == status_ok) then
         call move_alloc(new_springs, group)
         call model_add(model%mesh, group, node, direction, status)
      end if
      call handle_leave(handle)
   end subroutine springs

   !> Order and analyse; the sizes are known before the factor is allocated
   subroutine prepare(handle, ordering, most_values, refactor, threads, sizes, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_new, stage_prepared
      use sla_model, only : element_model, model_prepare
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: ordering             !! 0 AMD, 1 METIS
      integer(c_int64_t), intent(in) :: most_values      !! doubles the factor may take
      integer(c_int), intent(in) :: refactor             !! 1: factorise at each event
      integer(c_int), intent(in) :: threads
      integer(c_int64_t), intent(out) :: sizes(3)        !! equations, points, doubles of the factor
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      !f2py threadsafe
      sizes = 0
      call model_take(handle, stage_new, stage_new, model, status)
      if (status /= status_ok) return
      model%stiffness%refactor = refactor /= 0
      model%threads = max(1, int(threads))
      call model_prepare(model, ordering, most_values, status)
      sizes(1:2) = [int(model%mesh%equations, c_int64_t), int(model%mesh%points, c_int64_t)]
      sizes(3) = model%stiffness%factor_values
      if (status == status_ok) model%stage = stage_prepared
      call handle_leave(handle)
   end subroutine prepare

   !> Assemble and factorise the present damage
   subroutine factorise(handle, node, direction, ratio, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_prepared, stage_factored, stage_loaded
      use sla_model, only : element_model, model_factor
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(out) :: node          !! free to move, 0 none
      integer(c_int), intent(out) :: direction     !! which of its freedoms
      real(c_double), intent(out) :: ratio         !! smallest over largest pivot
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      !f2py threadsafe
      node = 0
      direction = 0
      ratio = 0.0_c_double
      call model_take(handle, stage_prepared, stage_loaded, model, status)
      if (status /= status_ok) return
      model%stage = stage_prepared
      call model_factor(model, node, direction, ratio, status)
      if (status == status_ok) model%stage = stage_factored
      call handle_leave(handle)
   end subroutine factorise

end module api_sla_model
