!> What the event loop of sequentially linear analysis knows of elements and materials.
!>
!> A group holds elements of one formulation with their integration points and their damage. The loop asks
!> it for the range of the load multiplier its points admit, tells it which point to damage and how, and
!> gets back the vectors by which the stiffness changes. New elements and materials are new groups, and nothing else has
!> to know them. What a new one provides:
!>
!>   its numbers   elements, freedoms of an element, points (the same number in each element, those of an element one
!>                 after the other), directions; options and tooth tables copied when it is made. Equations, their
!>                 factors and `offset` are set by model_add and model_prepare. No more than `most_entries` freedoms.
!>   matrix        the stiffness of an element as it is damaged now: at first the elastic one
!>   force         internal forces of all elements, by the same stiffness: the residual checks one with the other
!>   scan          for each point of a range of elements the stresses of both displacements, sa of ua and sb of ub, by
!>                 its own rows B' D; each criterion on sa + lambda sb by `linear_bound`, or one of closed form by
!>                 `offer_hi`, `offer_lo`, `offer_empty`, with the code of what happens there (list sla_event in
!>                 extrados_lists.h: one code per kind of event and direction, told apart by `damage` alone)
!>   damage        one tooth (sla_tables: modulus and strength by tooth) of one point at one code, and the change of the
!>                 stiffness as K_new = K - sum sign w w': rank-one vectors over the element's freedoms by `spread`, at
!>                 most `most_rank`. Stiffening vectors may come in any order. They must give the new `matrix` exactly.
!>   state         all that damage is, as `state_rows` numbers per point, there and back: resume and stages rest on it
!>   report        rows of numbers per point for figures, those of a plane point where they mean something
!>   margin        a lower bound of what a range of elements carries, by which regions may wait. A bound of -1 makes
!>                 them looked at in each event: right, and slow.
!>
!> A law that can be followed by the strain itself, without teeth, goes on by equilibrium iterations where events find
!> no equilibrium (sla_continuation): its group extends history_group. What has no points is linear there.
!>
!> Points that slide have forces beside their stiffness: their groups extend friction_group, see there.
!>
!> A constructor returns the offending element and a status of extrados_status.h (bad geometry, out of memory, invalid
!> argument); none of the procedures above may fail. The facade is that of `bars` in api_sla_model. Equations are by
!> node and direction (model_add): x and y in the plane, and of shells z and three rotations.
module sla_group
   use common_kinds, only : wp
   use common_lists, only : orthotropic => sla_cracking_orthotropic
   use common_status, only : status_ok, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: element_group, point_group, history_group, friction_group, group_holder, slider, point_place, point_event
   public :: bound
   public :: scan_result, event_vectors, material_options
   public :: below, unbounded, most_entries, most_rank, offer_hi, offer_lo, offer_empty, linear_bound, &
      component, along, admitted, report_rows, state_rows, history_rows, &
      damage_rows

   real(wp), parameter :: unbounded = huge(1.0_wp)
   !> Freedoms of an element; vectors of an event, as many as the factor takes (extrados_most_changes)
   integer, parameter :: most_entries = 24, most_rank = 5
   !> Rows of a point's report, see plane and bar
   integer, parameter :: report_rows = 19
   !> Most rows of a point's history
   integer, parameter :: history_rows = 8
   !> Rows, the first ones, that only grow: by them the point loses stiffness
   integer, parameter :: damage_rows = 3

   !> A point of a model
   type :: point_place
      integer :: group = 0             !! 0: none
      integer :: point = 0             !! of its group
   end type point_place

   !> What happens to a point
   type, extends(point_place) :: point_event
      integer :: code = 0              !! of the list sla_event
   end type point_event

   !> A limit of the load multiplier, the point that sets it and what happens there
   type :: bound
      real(wp) :: value = 0.0_wp
      integer :: group = 0
      integer :: point = 0
      integer :: code = 0
   end type bound

   !> Limits over many points; `empty` is the most overloaded point that no multiplier can relieve
   type :: scan_result
      type(bound) :: hi = bound(value=unbounded)
      type(bound) :: lo = bound(value=-unbounded)
      type(bound) :: empty = bound(value=0.0_wp)
      logical :: bounded = .false.   !! some point is limited
   end type scan_result

   !> Change of the stiffness by one event: K_new = K - sum sign(k) w(:, k) w(:, k)'
   type :: event_vectors
      integer :: rank = 0
      integer :: entries = 0
      integer(c_int) :: index(most_entries) = 0      !! equations, 1-based
      real(wp) :: w(most_entries, most_rank) = 0.0_wp
      real(wp) :: sign(most_rank) = 0.0_wp           !! +1 softens, -1 stiffens
      real(wp) :: origin(most_rank) = 0.0_wp         !! value of w.u at which the part that changes carries nothing
      real(wp) :: hold(2, most_rank) = 0.0_wp        !! change of a held force along w, constant and per multiplier
      real(wp) :: shift = 0.0_wp                     !! change of the energy of `origins` [J]
      logical :: cracks = .true.                     !! energy of softening springs is that of a crack
      real(wp) :: crack = 0.0_wp                     !! energy of the crack beside it, >= 0 [J]
   end type event_vectors

   !> A point that slides: a force h that follows the displacements, unlike a spring not symmetrically, see sla_friction
   type :: slider
      integer :: group = 0
      integer :: point = 0
      integer :: entries = 0
      integer(c_int) :: index(most_entries) = 0      !! equations, 0 held
      real(wp) :: across(most_entries) = 0.0_wp      !! across.u is the jump across the joint,
      real(wp) :: slip(most_entries) = 0.0_wp        !! slip.u that along it
      real(wp) :: area = 0.0_wp                      !! h acts on the nodes by -area slip [m^2]
      real(wp) :: law(2) = 0.0_wp                    !! h = law(1) across.u + law(2) slip.u [Pa/m]
      real(wp) :: held(2) = 0.0_wp                   !! h as it is, constant and per unit multiplier [Pa]
      ! The whole of its friction is spring slip + h, its strength that of sense strength across.u
      real(wp) :: strength = 0.0_wp                  !! [Pa/m]
      real(wp) :: spring = 0.0_wp                    !! in the stiffness [Pa/m]
      real(wp) :: elastic = 0.0_wp                   !! that of a point that sticks [Pa/m]
      real(wp) :: sense = 0.0_wp                     !! of the slip, +1 or -1; 0: it sticks
   end type slider

   !> How cracked material behaves, the same for the whole model
   type :: material_options
      integer(c_int) :: cracking = orthotropic   !! of the list sla_cracking
      real(wp) :: retention = -1.0_wp      !! constant shear retention, negative: thesis Eq. 4.11
      logical :: closure = .false.         !! closed cracks regain their stiffness
      integer :: most_changes = 10         !! openings and closings of a crack before it is left open
      real(wp) :: floor = 1.0e-6_wp        !! stiffness left after the last tooth over the initial one
      logical :: extent = .false.          !! the crack band of a quadrilateral is its extent across the crack
   end type material_options

   !> Elements that give stiffness
   type, abstract :: element_group
      integer :: elements = 0
      integer :: freedoms = 0              !! per element
      integer(c_int), allocatable :: equation(:, :)  !! (freedoms, elements), 0 held
      real(wp), allocatable :: factor(:, :)          !! share of the equation's displacement
      logical :: tied = .false.            !! a factor differs from one
   contains
      procedure(matrix_interface), deferred :: matrix
      procedure(force_interface), deferred :: force
      procedure :: gather
      procedure :: spread
   end type element_group

   !> Elements with integration points that can be damaged
   type, abstract, extends(element_group) :: point_group
      integer :: points = 0                !! of the group
      integer :: offset = 0                !! points of the groups before it
      integer :: directions = 2            !! crack directions of a point; a bar has one
      type(material_options) :: options
   contains
      procedure(scan_interface), deferred :: scan
      procedure(damage_interface), deferred :: damage
      procedure(report_interface), deferred :: report
      procedure(state_interface), deferred :: state
      procedure(margin_interface), deferred :: margin
   end type point_group

   !> Elements whose points keep histories: the greatest strains so far, which decide their damage
   type, abstract, extends(point_group) :: history_group
      real(wp), allocatable :: history(:, :)   !! (rows of the group's own, points), no more than history_rows
      real(wp), allocatable :: kept(:, :)      !! (rows, points) of the last state in equilibrium
      real(wp), allocatable :: rate(:, :)      !! (rows, points) growth in the last step
      real(wp), allocatable :: before_loop(:, :)   !! (rows, points) before the last loop of a staggered step
      real(wp), allocatable :: damage_kept(:, :)   !! (state_rows, points) there: crack bands that a step may fix
   contains
      procedure(continues_interface), deferred :: continues
      procedure(begin_interface), deferred :: begin
      procedure(respond_interface), deferred :: respond
      procedure(update_interface), deferred :: update
      procedure(go_ahead_interface), deferred :: go_ahead
      procedure(show_interface), deferred :: show
      procedure :: new_histories
      procedure :: keep
      procedure :: restore
      procedure :: extrapolate
   end type history_group

   !> Elements whose points can slide: their stress is k d - k0 + h, with a force h that follows the displacements, see
   !> sla_friction, and k0 that of a spring whose origin moved
   type, abstract, extends(history_group) :: friction_group
      logical :: slides = .false.          !! there is friction: points can come to have forces beside their stiffness
   contains
      procedure(origins_interface), deferred :: origins
      procedure(slipped_interface), deferred :: slipped
      procedure(sliding_interface), deferred :: sliding
      procedure(sliders_interface), deferred :: sliders
      procedure(turned_back_interface), deferred :: turned_back
      procedure(undecided_interface), deferred :: undecided
      procedure(set_held_interface), deferred :: set_held
      procedure(advance_interface), deferred :: advance
      procedure(excess_interface), deferred :: excess
      procedure(elastic_interface), deferred :: elastic
      procedure(couple_interface), deferred :: couple
   end type friction_group

   type :: group_holder
      class(element_group), allocatable :: group
   end type group_holder

   !> Rows of a point's stored damage: cosine, sine, cracked (and which crack band, see sla_plane_points), tension teeth
   !> (2), compression teeth (2), shut (2), changes (2)
   integer, parameter :: state_rows = 11

   abstract interface

      !> Stiffness matrix of an element in its own freedoms
      pure subroutine matrix_interface(group, element, k)
         import :: element_group, wp
         implicit none (type, external)
         class(element_group), intent(in) :: group
         integer, intent(in) :: element
         real(wp), intent(out) :: k(:, :)
      end subroutine matrix_interface

      !> Add the internal forces of all elements under the displacements u
      pure subroutine force_interface(group, u, f)
         import :: element_group, wp
         implicit none (type, external)
         class(element_group), intent(in) :: group
         real(wp), intent(in) :: u(0:)
         real(wp), intent(inout) :: f(0:)
      end subroutine force_interface

      !> Limits of the load multiplier over a range of elements
      pure subroutine scan_interface(group, first, last, ua, ub, lambda, noise, found)
         import :: point_group, wp, scan_result
         implicit none (type, external)
         class(point_group), intent(in) :: group
         integer, intent(in) :: first
         integer, intent(in) :: last
         real(wp), intent(in) :: ua(0:)
         real(wp), intent(in) :: ub(0:)
         real(wp), intent(in) :: lambda     !! where an overload is measured
         real(wp), intent(in) :: noise      !! stress under load B that counts as none [Pa]
         type(scan_result), intent(inout) :: found
      end subroutine scan_interface

      !> Damage (or close, or open) a point in the state ua + lambda ub
      pure subroutine damage_interface(group, point, code, lambda, ua, ub, event, tooth)
         import :: point_group, wp, event_vectors
         implicit none (type, external)
         class(point_group), intent(inout) :: group
         integer, intent(in) :: point
         integer, intent(in) :: code
         real(wp), intent(in) :: lambda
         real(wp), intent(in) :: ua(0:)
         real(wp), intent(in) :: ub(0:)
         type(event_vectors), intent(out) :: event
         integer, intent(out) :: tooth      !! the tooth reached
      end subroutine damage_interface

      !> State of all points at ua + lambda ub, rows as documented in the group
      pure subroutine report_interface(group, ua, ub, lambda, noise, values)
         import :: point_group, wp
         implicit none (type, external)
         class(point_group), intent(in) :: group
         real(wp), intent(in) :: ua(0:)
         real(wp), intent(in) :: ub(0:)
         real(wp), intent(in) :: lambda
         real(wp), intent(in) :: noise
         real(wp), intent(out) :: values(:, :)
      end subroutine report_interface

      !> Put the damage of all points into `values`, or take it from there
      pure subroutine state_interface(group, store, values)
         import :: point_group, wp
         implicit none (type, external)
         class(point_group), intent(inout) :: group
         logical, intent(in) :: store
         real(wp), intent(inout) :: values(:, :)   !! (state_rows, points)
      end subroutine state_interface

      !> What a range of elements can bear before a point leaves its limits at one of the multipliers `lambda`: the
      !> least sqrt(2 U) of the strain energies U [J] that a change of the displacements must bring into them.
      !> For a component of the stress that has `slack` left at a point of volume w and stiffness D of that
      !> component it is slack sqrt(w / D).
      pure subroutine margin_interface(group, first, last, ua, ub, lambda, least)
         import :: point_group, wp
         implicit none (type, external)
         class(point_group), intent(in) :: group
         integer, intent(in) :: first
         integer, intent(in) :: last
         real(wp), intent(in) :: ua(0:)
         real(wp), intent(in) :: ub(0:)
         real(wp), intent(in) :: lambda(:)
         real(wp), intent(inout) :: least(:)     !! sqrt(2 U) by multiplier [J^1/2]
      end subroutine margin_interface

      !> Can the law be followed without teeth?
      pure function continues_interface(group) result(yes)
         import :: history_group
         implicit none (type, external)
         class(history_group), intent(in) :: group
         logical :: yes
      end function continues_interface

      !> The histories that the teeth lost so far have come from
      subroutine begin_interface(group, u, status)
         import :: c_int, history_group, wp
         implicit none (type, external)
         class(history_group), intent(inout) :: group
         real(wp), intent(in) :: u(0:)       !! displacements that they belong to
         integer(c_int), intent(out) :: status
      end subroutine begin_interface

      !> Forces, symmetric matrix and stored energy of an element
      pure subroutine respond_interface(group, e, local, how, f, k, energy)
         import :: history_group, wp
         implicit none (type, external)
         class(history_group), intent(in) :: group
         integer, intent(in) :: e
         real(wp), intent(in) :: local(:)    !! displacements of its freedoms
         integer, intent(in) :: how          !! by_... of sla_coaxial
         real(wp), intent(out) :: f(:)
         real(wp), intent(out) :: k(:, :)    !! none where its size is 0
         real(wp), intent(out) :: energy     !! [J]
      end subroutine respond_interface

      !> What sliding friction adds to the matrix of an element by its tangent: the shear stress of pressed points grows
      !> with the pressure, not symmetrically
      pure subroutine couple_interface(group, e, local, k, couples)
         import :: friction_group, wp
         implicit none (type, external)
         class(friction_group), intent(in) :: group
         integer, intent(in) :: e
         real(wp), intent(in) :: local(:)
         real(wp), intent(out) :: k(:, :)
         logical, intent(out) :: couples     !! else k is zero
      end subroutine couple_interface

      !> The histories follow the displacements; the energy that this costs is added
      pure subroutine update_interface(group, u, lost)
         import :: history_group, wp
         implicit none (type, external)
         class(history_group), intent(inout) :: group
         real(wp), intent(in) :: u(0:)
         real(wp), intent(inout) :: lost     !! [J]
      end subroutine update_interface

      !> The histories grow on by a multiple of their growth in the last loop of a staggered step
      pure subroutine go_ahead_interface(group, u, ratio, lost)
         import :: history_group, wp
         implicit none (type, external)
         class(history_group), intent(inout) :: group
         real(wp), intent(in) :: u(0:)       !! displacements of that loop
         real(wp), intent(in) :: ratio       !! of the growth ahead to that of the loop
         real(wp), intent(inout) :: lost     !! the energy that this costs is added, now or by the next update [J]
      end subroutine go_ahead_interface

      !> Axes, teeth and stiffness of the points by their histories, for `report` and `state`
      pure subroutine show_interface(group, u)
         import :: history_group, wp
         implicit none (type, external)
         class(history_group), intent(inout) :: group
         real(wp), intent(in) :: u(0:)
      end subroutine show_interface

      !> Add the forces of k0 and of -h, and the energy that k0 alone leaves
      pure subroutine origins_interface(group, springs, held, energy)
         import :: friction_group, wp
         implicit none (type, external)
         class(friction_group), intent(in) :: group
         real(wp), intent(inout) :: springs(0:)    !! [N]
         real(wp), intent(inout) :: held(0:, :)    !! (0:, 2) constant and per unit multiplier [N]
         real(wp), intent(inout) :: energy         !! [J]
      end subroutine origins_interface

      !> Does a point have forces beside its stiffness?
      pure function slipped_interface(group) result(yes)
         import :: friction_group
         implicit none (type, external)
         class(friction_group), intent(in) :: group
         logical :: yes
      end function slipped_interface

      !> How many points slide
      pure function sliding_interface(group) result(count)
         import :: friction_group
         implicit none (type, external)
         class(friction_group), intent(in) :: group
         integer :: count
      end function sliding_interface

      !> Append the points that slide
      pure subroutine sliders_interface(group, list, count)
         import :: friction_group, slider
         implicit none (type, external)
         class(friction_group), intent(in) :: group
         type(slider), intent(inout) :: list(:)
         integer, intent(inout) :: count
      end subroutine sliders_interface

      !> Append the points that have stuck at this very load; `held` is the force of their friction, whose spring is
      !> whole
      pure subroutine turned_back_interface(group, lambda, list, count)
         import :: friction_group, slider, wp
         implicit none (type, external)
         class(friction_group), intent(in) :: group
         real(wp), intent(in) :: lambda
         type(slider), intent(inout) :: list(:)    !! ignored where it is too short
         integer, intent(inout) :: count
      end subroutine turned_back_interface

      !> Has a point that is about to change done the opposite at this very load?
      pure function undecided_interface(group, point, code, lambda) result(yes)
         import :: friction_group, wp
         implicit none (type, external)
         class(friction_group), intent(in) :: group
         integer, intent(in) :: point
         integer, intent(in) :: code
         real(wp), intent(in) :: lambda
         logical :: yes
      end function undecided_interface

      !> Take over the force h of a point that slides
      pure subroutine set_held_interface(group, point, held)
         import :: friction_group, wp
         implicit none (type, external)
         class(friction_group), intent(inout) :: group
         integer, intent(in) :: point
         real(wp), intent(in) :: held(2)     !! constant and per unit multiplier [Pa]
      end subroutine set_held_interface

      !> What slides has come as far as in the state ua + lambda ub
      pure subroutine advance_interface(group, lambda, ua, ub)
         import :: friction_group, wp
         implicit none (type, external)
         class(friction_group), intent(inout) :: group
         real(wp), intent(in) :: lambda
         real(wp), intent(in) :: ua(0:)
         real(wp), intent(in) :: ub(0:)
      end subroutine advance_interface

      !> Energy that the stiffness stores at points that slide and that their forces take back [J]
      pure function excess_interface(group, u) result(energy)
         import :: friction_group, wp
         implicit none (type, external)
         class(friction_group), intent(in) :: group
         real(wp), intent(in) :: u(0:)
         real(wp) :: energy
      end function excess_interface

      !> Energy of the elastic slip of points that slide, which their stiffness does not have [J]
      pure function elastic_interface(group, lambda, u) result(energy)
         import :: friction_group, wp
         implicit none (type, external)
         class(friction_group), intent(in) :: group
         real(wp), intent(in) :: lambda
         real(wp), intent(in) :: u(0:)
         real(wp) :: energy
      end function elastic_interface

   end interface

contains

   !> Histories of undamaged points
   subroutine new_histories(group, rows, status)
      class(history_group), intent(inout) :: group
      integer, intent(in) :: rows
      integer(c_int), intent(out) :: status
      integer :: info
      info = 0
      if (.not. allocated(group%history)) allocate (group%history(rows, group%points), &
         group%kept(rows, group%points), group%rate(rows, group%points), group%before_loop(rows, group%points), &
         group%damage_kept(state_rows, group%points), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      group%history(:, :) = 0.0_wp
      group%kept(:, :) = 0.0_wp
      group%rate(:, :) = 0.0_wp
      group%before_loop(:, :) = 0.0_wp
   end subroutine new_histories

   !> A state in equilibrium: its histories are those of the next step's start
   pure subroutine keep(group)
      class(history_group), intent(inout) :: group
      group%rate(:, :) = group%history - group%kept
      group%kept(:, :) = group%history
      call group%state(.true., group%damage_kept)
   end subroutine keep

   !> Back to the last state in equilibrium
   pure subroutine restore(group)
      class(history_group), intent(inout) :: group
      group%history(:, :) = group%kept
      call group%state(.false., group%damage_kept)
   end subroutine restore

   !> On from the last state in equilibrium at the rate of the last step
   pure subroutine extrapolate(group, ratio)
      class(history_group), intent(inout) :: group
      real(wp), intent(in) :: ratio        !! of this step to the last
      group%history(:, :) = group%kept + ratio * group%rate
   end subroutine extrapolate

   !> Displacements of an element's own freedoms
   pure subroutine gather(group, element, u, local)
      class(element_group), intent(in) :: group
      integer, intent(in) :: element
      real(wp), intent(in) :: u(0:)
      real(wp), intent(out) :: local(:)
      integer :: i
      do i = 1, group%freedoms
         local(i) = u(group%equation(i, element))
      end do
      if (group%tied) local(1:group%freedoms) = local(1:group%freedoms) * group%factor(1:group%freedoms, element)
   end subroutine gather

   !> A vector over the element's freedoms as entries by equation, those of one equation merged
   pure subroutine spread(group, element, local, event, k)
      class(element_group), intent(in) :: group
      integer, intent(in) :: element
      real(wp), intent(in) :: local(:)
      type(event_vectors), intent(inout) :: event
      integer, intent(in) :: k              !! which vector
      integer :: i, j
      integer(c_int) :: equation
      do i = 1, group%freedoms
         equation = group%equation(i, element)
         if (equation == 0) cycle
         do j = 1, event%entries
            if (event%index(j) == equation) exit
         end do
         if (j > event%entries) then
            event%entries = j
            event%index(j) = equation
         end if
         event%w(j, k) = event%w(j, k) + local(i) * group%factor(i, element)
      end do
   end subroutine spread

   !> w_i . x over the entries of an event
   pure function component(event, i, x) result(total)
      type(event_vectors), intent(in) :: event
      integer, intent(in) :: i
      real(wp), intent(in) :: x(0:)
      real(wp) :: total
      integer :: k
      total = 0.0_wp
      do k = 1, event%entries
         total = total + event%w(k, i) * x(event%index(k))
      end do
   end function component

   !> w_i . (x + lambda y) over the entries of an event: dot_product would gather them in memory that it does not ask
   !> for
   pure function along(event, i, x, y, lambda) result(total)
      type(event_vectors), intent(in) :: event
      integer, intent(in) :: i
      real(wp), intent(in) :: x(0:)
      real(wp), intent(in) :: y(0:)
      real(wp), intent(in) :: lambda
      real(wp) :: total
      integer :: k
      total = 0.0_wp
      do k = 1, event%entries
         total = total + event%w(k, i) * (x(event%index(k)) + lambda * y(event%index(k)))
      end do
   end function along

   !> True where a lies below b by more than rounding: limits that should be equal must not race
   elemental function below(a, b) result(less)
      real(wp), intent(in) :: a, b
      logical :: less
      real(wp), parameter :: tie = 1.0e-10_wp
      less = a < b
      if (less .and. abs(b) < unbounded .and. abs(a) < unbounded) less = b - a > tie * abs(b)
   end function below

   !> A new upper limit; the first of equals stays
   pure subroutine offer_hi(found, value, point, code)
      type(scan_result), intent(inout) :: found
      real(wp), intent(in) :: value
      integer, intent(in) :: point
      integer, intent(in) :: code
      found%bounded = .true.
      if (below(value, found%hi%value)) found%hi = bound(value, 0, point, code)
   end subroutine offer_hi

   !> A new lower limit; the first of equals stays
   pure subroutine offer_lo(found, value, point, code)
      type(scan_result), intent(inout) :: found
      real(wp), intent(in) :: value
      integer, intent(in) :: point
      integer, intent(in) :: code
      found%bounded = .true.
      if (below(-value, -found%lo%value)) found%lo = bound(value, 0, point, code)
   end subroutine offer_lo

   !> A point that no multiplier relieves; the greatest overload counts, the first of equals
   pure subroutine offer_empty(found, value, point, code)
      type(scan_result), intent(inout) :: found
      real(wp), intent(in) :: value        !! stress over strength, less one
      integer, intent(in) :: point
      integer, intent(in) :: code
      found%bounded = .true.
      if (found%empty%point == 0 .or. value > found%empty%value) then
        found%empty = bound(value, 0, point, code)
      end if
   end subroutine offer_empty

   !> Least and greatest multiplier that was found; the wrong way round where none relieves a point
   pure function admitted(found) result(range)
      type(scan_result), intent(in) :: found
      real(wp) :: range(2)
      range = [found%lo%value, found%hi%value]
      if (found%empty%point /= 0) range = [unbounded, -unbounded]
   end function admitted

   !> Limits of lambda from sa + lambda sb <= f
   pure subroutine linear_bound(sa, sb, f, scale, lambda, noise, point, code, found)
      real(wp), intent(in) :: sa, sb, f
      real(wp), intent(in) :: scale        !! strength an overload is measured by
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      integer, intent(in) :: point, code
      type(scan_result), intent(inout) :: found
      if (abs(sb) <= noise) then
         if (sa > f + 1.0e-9_wp * scale) call offer_empty(found, (sa + lambda * sb - f) / scale, point, code)
      else if (sb > 0.0_wp) then
         call offer_hi(found, (f - sa) / sb, point, code)
      else
         call offer_lo(found, (f - sa) / sb, point, code)
      end if
   end subroutine linear_bound

end module sla_group
