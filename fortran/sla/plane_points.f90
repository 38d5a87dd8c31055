!> Points of plane-stress elements: what damage leaves of stiffness and strength, and the loads that a point admits.
!>
!> In the crack axes (n, s) the compliance is [[1/En, -nu/E], [-nu/E, 1/Es]] (thesis Eqs 4.9, 4.10) and the shear
!> modulus follows the smaller of the two (Eq. 4.11) or keeps a constant part.
!>
!> The teeth of a point follow from the width of the crack band: given, or that of the element across the crack
!> that opens. Cracks follow a row of quadrilaterals, whose mean width is the area over the mean projection of both
!> diagonals onto the crack (Oliver 1989); they cross triangles wherever they meet them, and a straight line through a
!> mesh meets each as often as its extent across the line is wide: the extent then makes the energy right on average.
!> With options%extent, the same holds for quadrilaterals crossed by a crack that is oblique to the rows of the mesh.
!>
!> Strength and energy of a crack of bedded masonry are interpolated, f(n) = nx^2 fx + ny^2 fy: the very stress across
!> it as it opens, where a = 1 (see sla_bedding). Where a > 1 this stress is less, and strength and energy of that crack
!> are less by the same share. The teeth need no tables of their own: moduli depend on E Gf / (f^2 h) alone, so those
!> of another band serve, with all stresses in proportion.
!>
!> Crushing of confined masonry: -s2 <= fc - k s1, so that pressure across the greatest one helps and tension hurts
!> (Richart and others 1928 found k = 4.1 for concrete).
module sla_plane_points
   use common_kinds, only : wp
   ! The code of an event is one of these + 0 for the first, + 1 for the second crack direction.
   use common_lists, only : isotropic => sla_cracking_isotropic, code_tension => sla_event_tension, &
      code_compression => sla_event_compression, code_close => sla_event_close, code_open => sla_event_open, &
      element_t3 => sla_element_t3, element_t6 => sla_element_t6
   use common_status, only : status_ok, status_out_of_memory
   use sla_bedding, only : bedding, between, hill, hill_strength, in_joint_axes
   use sla_element, only : element_rule
   use sla_group, only : history_group, scan_result, material_options, most_entries, unbounded, offer_hi, offer_lo, &
      offer_empty, linear_bound
   use sla_interval, only : cone_interval, overload, quadratic_interval
   use sla_tables, only : tooth_tables, tooth_tables_copy
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: plane_points, points_new, points_ready, refresh_plane, axis_free, axis_joint, most_per
   public :: in_crack_axes, in_element_axes, stress_at, scan_point, is_bedded, open_bedded, share_of
   public :: direction_modulus, set_pair, set_band, width_across, is_triangle

   !> Points of an element, at most: four places of fifteen layers
   integer, parameter :: most_per = 60

   !> Cracks choose their direction; or they have a given one and keep the shear stiffness: a joint that opens and
   !> closes but does not slide
   integer(c_int), parameter :: axis_free = 0, axis_joint = 2

   !> Least part of its strength that shear leaves a crack of bedded masonry
   real(wp), parameter :: least_share = 0.2_wp
   !> Into how many steps that part is rounded
   real(wp), parameter :: share_steps = 1.0e6_wp

   !> Points of plane-stress elements, and of the layers of shells. A kind of element provides `strains` and `nodal`.
   type, abstract, extends(history_group) :: plane_points
      type(element_rule) :: rule
      integer :: per = 0                                 !! points of an element
      logical :: selective = .false.                     !! shear strain from the element's middle
      real(wp), allocatable :: weight(:)                 !! volume of a point [m^3]
      real(wp), allocatable :: young(:)                  !! (elements) [Pa]
      real(wp), allocatable :: nu(:)
      integer(c_int), allocatable :: table(:)            !! tension teeth, 0 none
      integer(c_int), allocatable :: ladder(:, :)        !! (2, elements) tables of narrowest and widest band, 0 none
      real(wp), allocatable :: diagonal(:, :, :)         !! (2, 2, elements), two sides of triangles [m]
      real(wp), allocatable :: side(:, :)                !! (2, elements) from the first corner to the second; 0 of triangles [m]
      integer(c_int), allocatable :: crush_table(:)      !! compression teeth, 0 none
      real(wp), allocatable :: lateral(:)                !! compressive strength that reduces ft, 0 none [Pa]
      real(wp), allocatable :: confinement(:)            !! growth of the compressive strength per lateral pressure
      type(tooth_tables) :: teeth
      type(bedding), allocatable :: bed(:)               !! (elements)
      integer(c_int), allocatable :: pair(:, :)          !! (2, points) tables of both cracks of bedded masonry
      integer(c_int), allocatable :: axis(:)             !! axis_free, 1 one crack direction given, axis_joint
      ! The damage: everything else below follows from it.
      real(wp), allocatable :: turn(:, :)                !! (2, points) cosine and sine of the crack normal
      !> 0 without crack axes, else 1 + step on the ladder; of bedded masonry 1 + steps of the share that is lost
      integer(c_int), allocatable :: cracked(:)
      integer(c_int), allocatable :: tooth(:, :)         !! (2, points), 1 virgin
      integer(c_int), allocatable :: crush(:, :)         !! (2, points), 1 virgin
      integer(c_int), allocatable :: shut(:, :)          !! (2, points), 1 closed
      integer(c_int), allocatable :: changes(:, :)       !! (2, points) openings and closings
      real(wp), allocatable :: stiff(:, :)               !! (4, points) Dnn, Dns, Dss, G [Pa]
      real(wp), allocatable :: limit(:, :)               !! (4, points) tension n, s, compression n, s [Pa]
   contains
      procedure(strains_interface), deferred :: strains
      procedure(nodal_interface), deferred :: nodal
      procedure :: scan
      procedure :: margin
      procedure :: refresh => refresh_plane
      procedure :: table_of
   end type plane_points

   abstract interface

      !> Strains x, y, xy of all points of an element, in its axes, from the displacements of its freedoms
      pure subroutine strains_interface(group, e, local, eps)
         import :: plane_points, wp
         implicit none (type, external)
         class(plane_points), intent(in) :: group
         integer, intent(in) :: e
         real(wp), intent(in) :: local(:)
         real(wp), intent(out) :: eps(:, :)     !! (3, points of the element)
      end subroutine strains_interface

      !> Forces in the freedoms of an element of the stress v, in its axes, in a unit of volume at a point
      pure subroutine nodal_interface(group, e, p, v, local)
         import :: plane_points, wp
         implicit none (type, external)
         class(plane_points), intent(in) :: group
         integer, intent(in) :: e
         integer, intent(in) :: p
         real(wp), intent(in) :: v(3)
         real(wp), intent(out) :: local(:)
      end subroutine nodal_interface

   end interface

contains

   !> Material and damage, which is none, of a group that knows its elements and the points of each; its maker sets
   !> `weight`, `diagonal` and `side`, then calls points_ready
   subroutine points_new(group, property, choice, teeth, options, status)
      class(plane_points), intent(inout) :: group
      !> (14, elements) thickness [m], Young's modulus [Pa], Poisson's ratio, lateral strength [Pa], angle of the only
      !> crack normal allowed [rad], confinement, and the components of `bedding` in their order
      real(wp), intent(in) :: property(:, :)
      !> (5, elements) tables of tension teeth of uncracked points, of the narrowest and the widest band, of compression
      !> teeth; 0 cracks choose their direction, 1 one normal is given, 2 also the shear is kept
      integer(c_int), intent(in) :: choice(:, :)
      type(tooth_tables), intent(in) :: teeth
      type(material_options), intent(in) :: options
      integer(c_int), intent(out) :: status
      integer :: e, k, ne, np, info

      ne = group%elements
      np = ne * group%per
      group%points = np
      group%options = options
      call tooth_tables_copy(teeth, group%teeth, status)
      if (status /= status_ok) return
      allocate (group%weight(np), group%young(ne), group%nu(ne), group%table(ne), group%crush_table(ne), &
         group%lateral(ne), group%axis(ne), group%ladder(2, ne), group%diagonal(2, 2, ne), group%side(2, ne), &
         group%confinement(ne), group%bed(ne), group%pair(2, merge(np, 0, any(property(8, :) > 0.0_wp))), group%turn(2, np), &
         group%cracked(np), group%tooth(2, np), group%crush(2, np), group%shut(2, np), group%changes(2, np), &
         group%stiff(4, np), group%limit(4, np), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      group%young(:) = property(2, :)
      group%nu(:) = property(3, :)
      group%table(:) = choice(1, :)
      group%ladder(:, :) = choice(2:3, :)
      group%crush_table(:) = choice(4, :)
      group%lateral(:) = property(4, :)
      group%confinement(:) = property(6, :)
      group%axis(:) = choice(5, :)
      group%pair = 0
      group%tooth = 1
      group%crush = 1
      group%shut = 0
      group%changes = 0
      do e = 1, ne
         associate (bed => property(7:14, e))
            group%bed(e) = bedding(bed(1), bed(2), bed(3), bed(4), bed(5), bed(6), bed(7), bed(8))
         end associate
         do k = (e - 1) * group%per + 1, e * group%per
            group%turn(:, k) = [1.0_wp, 0.0_wp]
            if (choice(5, e) /= axis_free) group%turn(:, k) = [cos(property(5, e)), sin(property(5, e))]
            group%cracked(k) = merge(1_c_int, 0_c_int, choice(5, e) /= axis_free)
         end do
      end do
   end subroutine points_new

   !> What follows from the material of all points once their geometry is known
   pure subroutine points_ready(group)
      class(plane_points), intent(inout) :: group
      integer :: e, p
      do p = 1, group%points
         e = (p - 1) / group%per + 1
         if (group%cracked(p) /= 0 .and. is_bedded(group, e)) call set_pair(group, e, p)
         call group%refresh(p)
      end do
   end subroutine points_ready

   !> Stiffness (thesis Eqs 4.9 to 4.11) and strengths of a point from its damage
   pure subroutine refresh_plane(group, p)
      class(plane_points), intent(inout) :: group
      integer, intent(in) :: p
      integer :: e, k
      real(wp) :: e0, nu, modulus(2), tension, compression, ratio, least

      e = (p - 1) / group%per + 1
      e0 = group%young(e)
      nu = group%nu(e)
      group%limit(:, p) = unbounded
      do k = 1, 2
         tension = group%teeth%modulus_of(group%table_of(e, p, k), group%tooth(k, p), e0, group%options%floor)
         compression = group%teeth%modulus_of(group%crush_table(e), group%crush(k, p), e0, group%options%floor)
         modulus(k) = min(tension, compression)
         if (group%shut(k, p) /= 0) modulus(k) = compression
         ! A tooth ends at its strain: where the other sign's damage governs, the stress is less.
         if (group%shut(k, p) == 0) group%limit(k, p) = &
            group%teeth%strength_of(group%table_of(e, p, k), group%tooth(k, p), &
            share_of(group, e, p, k) * modulus(k) / tension)
         group%limit(k + 2, p) = group%teeth%strength_of(group%crush_table(e), group%crush(k, p), &
            modulus(k) / compression)
         if (group%bed(e)%crush > 0.0_wp .and. group%cracked(p) > 0 .and. group%limit(k + 2, p) < unbounded) then
            group%limit(k + 2, p) = group%limit(k + 2, p) * hill_strength(group%bed(e), normal_of(group, p, k))
         end if
      end do
      if (group%options%cracking == isotropic) modulus(2) = modulus(1)
      ratio = 1.0_wp / (1.0_wp - nu**2 * modulus(1) * modulus(2) / e0**2)
      if (group%options%cracking == isotropic) then
         ratio = 1.0_wp / (1.0_wp - nu**2)
         group%stiff(:, p) = modulus(1) * [ratio, nu * ratio, ratio, 0.5_wp / (1.0_wp + nu)]
         return
      end if
      group%stiff(1:3, p) = ratio * [modulus(1), nu / e0 * modulus(1) * modulus(2), modulus(2)]
      if (group%axis(e) == axis_joint) then
         group%stiff(4, p) = 0.5_wp * e0 / (1.0_wp + nu)
         return
      end if
      least = minval(modulus)
      if (group%options%retention < 0.0_wp .or. least >= e0) then
         group%stiff(4, p) = 0.5_wp * least / (1.0_wp + nu * least / e0)
      else
         group%stiff(4, p) = group%options%retention * 0.5_wp * e0 / (1.0_wp + nu)
      end if
   end subroutine refresh_plane

   !> Secant modulus of one crack direction [Pa]
   pure function direction_modulus(group, e, p, k) result(modulus)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: e, p, k
      real(wp) :: modulus
      modulus = group%teeth%modulus_of(group%crush_table(e), group%crush(k, p), group%young(e), group%options%floor)
      if (group%shut(k, p) == 0) modulus = min(modulus, &
         group%teeth%modulus_of(group%table_of(e, p, k), group%tooth(k, p), group%young(e), group%options%floor))
   end function direction_modulus

   !> A strain in the axes of the element as it is in those of the crack
   pure function in_crack_axes(group, p, eps) result(turned)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: p
      real(wp), intent(in) :: eps(3)
      real(wp) :: turned(3), c, s

      if (group%cracked(p) == 0) then
         turned = eps
      else
         c = group%turn(1, p)
         s = group%turn(2, p)
         associate (x => eps(1), y => eps(2), g => eps(3))
            turned = [c**2 * x + s**2 * y + c * s * g, s**2 * x + c**2 * y - c * s * g, &
               2.0_wp * c * s * (y - x) + (c**2 - s**2) * g]
         end associate
      end if
   end function in_crack_axes

   !> Stress from strain, both in the crack axes [Pa]
   pure function stress_at(group, p, eps) result(sigma)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: p
      real(wp), intent(in) :: eps(3)
      real(wp) :: sigma(3)
      sigma = [group%stiff(1, p) * eps(1) + group%stiff(2, p) * eps(2), &
         group%stiff(2, p) * eps(1) + group%stiff(3, p) * eps(2), group%stiff(4, p) * eps(3)]
   end function stress_at

   !> R' v: a stress in the axes of the crack as it is in those of the element
   pure function in_element_axes(group, p, v) result(straight)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: p
      real(wp), intent(in) :: v(3)
      real(wp) :: straight(3), c, s

      c = group%turn(1, p)
      s = group%turn(2, p)
      if (group%cracked(p) == 0) then
         c = 1.0_wp
         s = 0.0_wp
      end if
      straight = [c**2 * v(1) + s**2 * v(2) - 2.0_wp * c * s * v(3), &
         s**2 * v(1) + c**2 * v(2) + 2.0_wp * c * s * v(3), &
         c * s * (v(1) - v(2)) + (c**2 - s**2) * v(3)]
   end function in_element_axes

   pure subroutine scan(group, first, last, ua, ub, lambda, noise, found)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      type(scan_result), intent(inout) :: found
      real(wp) :: la(most_entries), lb(most_entries), ea(3, most_per), eb(3, most_per), sa(3), sb(3)
      logical :: simple
      integer :: e, p, i, j

      do e = first, last
         if (group%table(e) == 0 .and. group%crush_table(e) == 0) cycle
         do i = 1, group%freedoms
            la(i) = ua(group%equation(i, e))
            lb(i) = ub(group%equation(i, e))
         end do
         if (group%tied) then
            la(1:group%freedoms) = la(1:group%freedoms) * group%factor(:, e)
            lb(1:group%freedoms) = lb(1:group%freedoms) * group%factor(:, e)
         end if
         call group%strains(e, la, ea)
         call group%strains(e, lb, eb)
         simple = group%table(e) /= 0 .and. group%crush_table(e) == 0 .and. group%lateral(e) <= 0.0_wp .and. &
            .not. is_bedded(group, e)
         do p = (e - 1) * group%per + 1, e * group%per
            j = p - (e - 1) * group%per
            sa = stress_at(group, p, in_crack_axes(group, p, ea(:, j)))
            sb = stress_at(group, p, in_crack_axes(group, p, eb(:, j)))
            if (simple .and. group%cracked(p) == 0 .and. found%hi%value < unbounded .and. &
                found%lo%value > -unbounded) then
               ! Nearly all points end here: they admit both limits found so far, see cone.
               if (inside_cone(group%limit(1, p), 1.0_wp, sa + found%hi%value * sb)) then
                  if (inside_cone(group%limit(1, p), 1.0_wp, sa + found%lo%value * sb)) cycle
               end if
            end if
            call scan_point(group, e, p, sa, sb, lambda, noise, found)
         end do
      end do
   end subroutine scan

   !> Limits of one point from its stresses in the crack axes
   pure subroutine scan_point(group, e, p, sa, sb, lambda, noise, found)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: sa(3)       !! constant loads [Pa]
      real(wp), intent(in) :: sb(3)       !! per unit multiplier [Pa]
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      type(scan_result), intent(inout) :: found
      real(wp) :: f, fc, gain, more
      integer :: k

      if (group%cracked(p) == 0 .or. (group%options%cracking == isotropic .and. group%axis(e) == axis_free)) then
         f = group%limit(1, p)
         if (f < unbounded .and. is_bedded(group, e)) then
            call limit_by_cone(f, 1.0_wp, in_joint_axes(group%bed(e), sa, f), in_joint_axes(group%bed(e), sb, &
               0.0_wp), lambda, &
               noise, p, code_tension, found)
         else if (f < unbounded) then
            call limit_by_cone(f, 1.0_wp, sa, sb, lambda, noise, p, code_tension, found)
            fc = group%lateral(e)
            if (fc > 0.0_wp) call limit_by_cone(f * fc / (f + fc), (fc - f) / (fc + f), sa, sb, lambda, noise, p, &
               code_tension, found)
         end if
         f = group%limit(3, p)
         more = group%confinement(e)
         if (f < unbounded .and. group%bed(e)%crush > 0.0_wp) then
            call limit_by_ellipse(group%bed(e), f, sa, sb, noise, lambda, p, code_compression + 1, found)
         else if (f < unbounded) then
            call limit_by_cone(f / (1.0_wp + more), (more - 1.0_wp) / (more + 1.0_wp), sa, sb, lambda, noise, &
               p, code_compression + 1, found)
         end if
         return
      end if
      do k = 1, merge(1, 2, group%axis(e) /= axis_free)
         f = group%limit(k, p)
         if (f < unbounded) call linear_bound(sa(k), sb(k), f, f, lambda, noise, p, code_tension + k - 1, found)
         fc = group%limit(k + 2, p)
         if (fc < unbounded) then
            more = group%confinement(e)
            call linear_bound(more * sa(3 - k) - sa(k), more * sb(3 - k) - sb(k), fc, fc, lambda, noise, p, &
               code_compression + k - 1, found)
         end if
         if (.not. group%options%closure .or. group%tooth(k, p) == 1) cycle
         f = group%teeth%strength_of(group%table_of(e, p, k), 1_c_int, 1.0_wp)
         if (group%shut(k, p) /= 0) then
            call linear_bound(sa(k), sb(k), 0.0_wp, f, lambda, noise, p, code_open + k - 1, found)
         else if (group%changes(k, p) < group%options%most_changes) then
            ! Measured by the strain: the stress that an open crack has left drowns in rounding.
            gain = group%young(e) / direction_modulus(group, e, p, k)
            call linear_bound(-gain * sa(k), -gain * sb(k), 0.0_wp, f, lambda, noise, p, code_close + k - 1, found)
         end if
      end do

   end subroutine scan_point

   !> Limits of an uncracked point under one criterion
   pure subroutine limit_by_cone(alpha, beta, sa, sb, lambda, noise, p, code, found)
      real(wp), intent(in) :: alpha, beta        !! r <= alpha - beta m, see sla_interval
      real(wp), intent(in) :: sa(3), sb(3)       !! [Pa]
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      integer, intent(in) :: p, code
      type(scan_result), intent(inout) :: found
      real(wp) :: lo, hi

      found%bounded = .true.
      if (maxval(abs(sb)) <= noise) then
         if (overload(alpha, beta, sa) > 1.0e-9_wp) call offer_empty(found, overload(alpha, beta, sa), p, code)
         return
      end if
      ! The set is convex: a point that admits both limits found so far cannot tighten them.
      if (found%hi%value < unbounded .and. found%lo%value > -unbounded) then
         if (inside_cone(alpha, beta, sa + found%hi%value * sb)) then
            if (inside_cone(alpha, beta, sa + found%lo%value * sb)) return
         end if
      end if
      call cone_interval(alpha, beta, sa, sb, lo, hi)
      if (lo > hi) then
         call offer_empty(found, overload(alpha, beta, sa + lambda * sb), p, code)
      else
         if (hi < unbounded) call offer_hi(found, hi, p, code)
         if (lo > -unbounded) call offer_lo(found, lo, p, code)
      end if
   end subroutine limit_by_cone

   !> Limits of an uncracked point under Hill's criterion
   pure subroutine limit_by_ellipse(bed, f, sa, sb, noise, lambda, p, code, found)
      type(bedding), intent(in) :: bed
      real(wp), intent(in) :: f                  !! compressive strength across the beds [Pa]
      real(wp), intent(in) :: sa(3), sb(3)       !! [Pa]
      real(wp), intent(in) :: noise
      real(wp), intent(in) :: lambda
      integer, intent(in) :: p, code
      type(scan_result), intent(inout) :: found
      real(wp) :: lo, hi, state(3), over
      found%bounded = .true.
      state = sa + lambda * sb
      over = sqrt(hill(bed, state, state)) / f - 1.0_wp
      if (maxval(abs(sb)) <= noise) then
         if (over > 1.0e-9_wp) call offer_empty(found, over, p, code)
         return
      end if
      call quadratic_interval(hill(bed, sa, sa) - f**2, hill(bed, sa, sb), hill(bed, sb, sb), lo, hi)
      if (lo > hi) then
         call offer_empty(found, over, p, code)
      else
         call offer_hi(found, hi, p, code)
         call offer_lo(found, lo, p, code)
      end if
   end subroutine limit_by_ellipse

   !> True where the stress lies safely inside r <= alpha - beta m; in this module so that it is inlined
   pure function inside_cone(alpha, beta, s) result(inside)
      real(wp), intent(in) :: alpha, beta
      real(wp), intent(in) :: s(3)    !! sx, sy, txy [Pa]
      logical :: inside
      real(wp) :: margin
      margin = alpha - beta * 0.5_wp * (s(1) + s(2))
      inside = margin >= 0.0_wp .and. margin**2 >= 0.25_wp * (s(1) - s(2))**2 + s(3)**2
   end function inside_cone

   !> See point_group: the same limits as scan_point
   pure subroutine margin(group, first, last, ua, ub, lambda, least)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: least(:)
      real(wp) :: la(most_entries), lb(most_entries), ea(3, most_per), eb(3, most_per), sa(3), sb(3), share, f, fc, &
         nu, more, change
      integer :: e, p, k, j

      do e = first, last
         if (group%table(e) == 0 .and. group%crush_table(e) == 0) cycle
         ! Hill's criterion has no bound yet
         if (group%bed(e)%crush > 0.0_wp) then
            least = -1.0_wp
            return
         end if
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         call group%strains(e, la, ea)
         call group%strains(e, lb, eb)
         do p = (e - 1) * group%per + 1, e * group%per
            j = p - (e - 1) * group%per
            sa = stress_at(group, p, in_crack_axes(group, p, ea(:, j)))
            sb = stress_at(group, p, in_crack_axes(group, p, eb(:, j)))
            if (group%cracked(p) == 0 .or. (group%options%cracking == isotropic .and. &
                group%axis(e) == axis_free)) then
               share = sqrt(group%weight(p) / group%stiff(1, p))
               f = group%limit(1, p)
               if (f < unbounded .and. is_bedded(group, e)) then
                  ! Shear of the image changes more than that of the stress: c' D c of the worst direction c
                  nu = group%stiff(2, p) / group%stiff(1, p)
                  call lower_margin(f, 1.0_wp, in_joint_axes(group%bed(e), sa, f), in_joint_axes(group%bed(e), sb, &
                     0.0_wp), &
                     share / sqrt(1.0_wp + 0.5_wp * (1.0_wp - nu) * (group%bed(e)%shear**2 - 1.0_wp)), lambda, least)
               else if (f < unbounded) then
                  call lower_margin(f, 1.0_wp, sa, sb, share, lambda, least)
                  fc = group%lateral(e)
                  if (fc > 0.0_wp) call lower_margin(f * fc / (f + fc), (fc - f) / (fc + f), sa, sb, share, lambda, &
                     least)
               end if
               f = group%limit(3, p)
               more = group%confinement(e)
               if (f < unbounded) call lower_margin(f / (1.0_wp + more), (more - 1.0_wp) / (more + 1.0_wp), sa, sb, &
                  share, &
                  lambda, least)
               cycle
            end if
            do k = 1, merge(1, 2, group%axis(e) /= axis_free)
               share = sqrt(group%weight(p) / group%stiff(2 * k - 1, p))
               f = group%limit(k, p)
               if (f < unbounded) least = min(least, share * (f - sa(k) - lambda * sb(k)))
               fc = group%limit(k + 2, p)
               if (fc < unbounded) then
                  more = group%confinement(e)
                  change = group%stiff(2 * k - 1, p) - 2.0_wp * more * group%stiff(2, p) + &
                     more**2 * group%stiff(5 - 2 * k, p)
                  least = min(least, sqrt(group%weight(p) / change) * (fc + sa(k) - more * sa(3 - k) + lambda * ( &
                     sb(k) - more * sb(3 - k))))
               end if
               if (.not. group%options%closure .or. group%tooth(k, p) == 1) cycle
               if (group%shut(k, p) /= 0) then
                  least = min(least, -share * (sa(k) + lambda * sb(k)))
               else if (group%changes(k, p) < group%options%most_changes) then
                  least = min(least, share * (sa(k) + lambda * sb(k)))
               end if
            end do
         end do
      end do

   end subroutine margin

   !> What r <= alpha - beta m has left; for |beta| <= 1 no more than the greater principal stress of a change uses it
   pure subroutine lower_margin(alpha, beta, sa, sb, share, lambda, least)
      real(wp), intent(in) :: alpha, beta        !! see sla_interval
      real(wp), intent(in) :: sa(3), sb(3)       !! [Pa]
      real(wp), intent(in) :: share              !! factor on the stress that is left
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: least(:)
      real(wp) :: left
      integer :: j
      do j = 1, size(lambda)
         left = alpha - beta * 0.5_wp * (sa(1) + sa(2) + lambda(j) * (sb(1) + sb(2))) &
            - sqrt(0.25_wp * (sa(1) - sa(2) + lambda(j) * (sb(1) - sb(2)))**2 + (sa(3) + lambda(j) * sb(3))**2)
         least(j) = min(least(j), share * left)
      end do
   end subroutine lower_margin

   !> Table of a point's tension teeth: of its element's until it cracks, then of its crack band
   pure function table_of(group, e, p, k) result(table)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      integer, intent(in) :: k         !! crack direction: bedded masonry has a table for each
      integer(c_int) :: table
      table = group%table(e)
      if (group%ladder(1, e) == 0 .or. group%cracked(p) == 0) return
      if (is_bedded(group, e)) then
         table = group%pair(k, p)
      else
         table = min(group%ladder(1, e) + group%cracked(p) - 1_c_int, group%ladder(2, e))
      end if
   end function table_of

   !> The crack band across the crack axes; teeth that were passed become those of as much stiffness
   pure subroutine set_band(group, e, p)
      class(plane_points), intent(inout) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp) :: modulus
      integer(c_int) :: old(2), new
      integer :: k
      if (group%ladder(1, e) == 0) return
      old = [group%table_of(e, p, 1), group%table_of(e, p, 2)]
      if (is_bedded(group, e)) then
         call set_pair(group, e, p)
      else
         new = group%teeth%nearest_band(group%ladder(1, e), group%ladder(2, e), &
            width_across(group, e, group%turn(:, p)))
         group%cracked(p) = 1_c_int + new - group%ladder(1, e)
      end if
      do k = 1, 2
         new = group%table_of(e, p, k)
         if (new == old(k) .or. group%tooth(k, p) == 1) cycle
         modulus = group%teeth%modulus_of(old(k), group%tooth(k, p), group%young(e), group%options%floor)
         group%tooth(k, p) = group%teeth%tooth_of(new, modulus)
      end do
   end subroutine set_band

   !> The tables of both cracks of bedded masonry
   pure subroutine set_pair(group, e, p)
      class(plane_points), intent(inout) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp) :: stretch, normal(2)
      integer :: k
      do k = 1, 2
         normal = normal_of(group, p, k)
         stretch = kept(group, p, k) * between(group%bed(e), normal, group%bed(e)%strength)**2 &
            / between(group%bed(e), normal, group%bed(e)%energy)
         group%pair(k, p) = group%teeth%nearest_band(group%ladder(1, e), group%ladder(2, e), &
            stretch * width_across(group, e, group%turn(:, p)))
      end do
   end subroutine set_pair

   !> Crack band of a crack of the normal n: the element's width across it, see the head of this module [m]
   pure function width_across(group, e, n) result(width)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: n(2)
      real(wp) :: width, a(2), b(2), along(2), corner(4)
      width = group%bed(e)%width
      if (width > 0.0_wp) return
      a = group%diagonal(:, 1, e)
      b = group%diagonal(:, 2, e)
      along = [a(2) * n(1) - a(1) * n(2), b(2) * n(1) - b(1) * n(2)]
      if (is_triangle(group) .or. group%options%extent) then
         associate (side => group%side(:, e))
            corner = [0.0_wp, dot_product(side, n), dot_product(a, n), dot_product(side + b, n)]
         end associate
         width = maxval(corner) - minval(corner)
      else
         width = abs(a(1) * b(2) - a(2) * b(1)) / sum(abs(along))
      end if
   end function width_across

   pure function is_triangle(group) result(yes)
      class(plane_points), intent(in) :: group
      logical :: yes
      yes = group%rule%kind == element_t3 .or. group%rule%kind == element_t6
   end function is_triangle

   !> Does the strength of an element depend on the direction to its bed joints?
   pure function is_bedded(group, e) result(yes)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: e
      logical :: yes
      yes = group%bed(e)%strength > 0.0_wp
   end function is_bedded

   !> The first crack of bedded masonry: its direction, and the share of the interpolated strength it opens at
   pure subroutine open_bedded(group, e, p, s, cracks)
      class(plane_points), intent(inout) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: s(3)     !! sx, sy, txy [Pa]
      logical, intent(in) :: cracks    !! else it crushes
      real(wp) :: f, phi, image(3), c, sn, across
      f = group%limit(1, p)
      image = s
      phi = 0.0_wp
      if (cracks) then
         image = in_joint_axes(group%bed(e), s, f)
         phi = group%bed(e)%angle
      end if
      phi = phi + 0.5_wp * atan2(2.0_wp * image(3), image(1) - image(2))
      c = cos(phi)
      sn = sin(phi)
      group%turn(:, p) = [c, sn]
      group%cracked(p) = 1
      if (.not. cracks .or. group%bed(e)%shear <= 1.0_wp) return
      across = (c**2 * s(1) + sn**2 * s(2) + 2.0_wp * c * sn * s(3)) / (share_of(group, e, p, 1) * f)
      group%cracked(p) = 1_c_int + nint(share_steps * (1.0_wp - min(max(across, least_share), 1.0_wp)), c_int)
   end subroutine open_bedded

   !> Strength of one crack direction of a cracked point over that of its tables: 1 but for bedded masonry
   pure function share_of(group, e, p, k) result(share)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: e, p, k
      real(wp) :: share
      share = 1.0_wp
      if (group%cracked(p) == 0 .or. .not. is_bedded(group, e)) return
      share = between(group%bed(e), normal_of(group, p, k), group%bed(e)%strength) * kept(group, p, k)
   end function share_of

   !> Normal of a crack
   pure function normal_of(group, p, k) result(n)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: p, k
      real(wp) :: n(2)
      n = group%turn(:, p)
      if (k == 2) n = [-n(2), n(1)]
   end function normal_of

   !> What shear has left of the strength of a crack
   pure function kept(group, p, k) result(part)
      class(plane_points), intent(in) :: group
      integer, intent(in) :: p, k
      real(wp) :: part
      part = 1.0_wp
      if (k == 1) part = 1.0_wp - real(group%cracked(p) - 1, wp) / share_steps
   end function kept

end module sla_plane_points
