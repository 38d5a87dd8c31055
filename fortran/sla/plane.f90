!> Plane-stress elements of fixed orthogonal cracks with saw-tooth softening (thesis 4.3.2).
!>
!> In the crack axes (n, s) the compliance is [[1/En, -nu/E], [-nu/E, 1/Es]] (Eqs 4.9, 4.10) and the shear
!> modulus follows the smaller of the two (Eq. 4.11) or keeps a constant part. One tooth changes one
!> diagonal term of the compliance and the shear modulus: the stiffness changes by rank two.
!>
!> Rotating cracks (Cope and others 1980; Rots 1988) turn with the principal strain, at each tooth of the point. Fixed
!> ones keep the direction of their first tooth, which is seldom that of the crack that opens later: the stress along
!> them then carries load across it ("stress locking", Rots 1988; Jirasek and Zimmermann 1998). What is left of it in
!> elements that the crack crosses askew goes where the stiffness along an opening crack is bounded by a multiple of
!> that across it, which in the end makes the damage a scalar one, as Jirasek and Zimmermann propose.
!>
!> The teeth of a point follow from the width of the crack band: given, or that of the element across the crack
!> that opens. Cracks follow a row of quadrilaterals, whose mean width is the area over the mean projection of both
!> diagonals onto the crack (Oliver 1989); they cross triangles wherever they meet them, and a straight line through a
!> mesh meets each as often as its extent across the line is wide: the extent then makes the energy right on average.
!>
!> Masonry laid in courses (bedded) is weaker across its bed joints than along them. Its uncracked points follow
!> Rankine's criterion with two strengths (Lourenco, de Borst and Rots 1997): in the axes of the joints, x along the
!> beds, (fx - sx)(fy - sy) >= a t^2 with a = fx fy / shear strength^2. That is the isotropic one of the image
!> (sx - fx + f, sy - fy + f, sqrt(a) t) with the strength f, so lambda has the same closed form; the crack's normal is
!> the principal direction of the image, which is turned towards that of the weaker joints. Strength and energy of
!> a crack are interpolated, f(n) = nx^2 fx + ny^2 fy: the very stress across it as it opens, where a = 1. Where a > 1
!> this stress is less, and strength and energy of that crack are less by the same share. The teeth need no tables of
!> their own: moduli depend on E Gf / (f^2 h) alone, so those of another band serve, with all stresses in proportion.
!>
!> Crushing of confined masonry: -s2 <= fc - k s1, so that pressure across the greatest one helps and tension hurts
!> (Richart and others 1928 found k = 4.1 for concrete).
!>
!> The damage of a point is kept per direction: tension tooth, compression tooth, crack shut or open.
module sla_plane
   use common_kinds, only : wp
   ! The code of an event is one of these + 0 for the first, + 1 for the second crack direction.
   use common_lists, only : isotropic => sla_cracking_isotropic, rotating => sla_cracking_rotating
   use common_lists, only : code_tension => sla_event_tension, code_compression => sla_event_compression, &
      code_close => sla_event_close, code_open => sla_event_open, element_q4 => sla_element_q4, &
      element_t3 => sla_element_t3, element_t6 => sla_element_t6
   use common_status, only : status_ok, status_out_of_memory, status_invalid_argument
   use sla_element, only : element_rule, element_rule_new, element_gradients, most_nodes, most_points
   use sla_group, only : point_group, scan_result, event_vectors, material_options, unbounded, &
      offer_hi, offer_lo, offer_empty, linear_bound
   use sla_interval, only : cone_interval, overload
   use sla_tables, only : tooth_tables, tooth_tables_copy
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: plane_group, plane_group_new

   !> Cracks choose their direction; or they have a given one and keep the shear stiffness: a joint that opens and
   !> closes but does not slide
   integer(c_int), parameter :: axis_free = 0, axis_joint = 2

   !> A crack that lies nearer to the principal strain than this stays where it is: one vector less in an event [rad]
   real(wp), parameter :: least_turn = 0.01_wp

   !> Stiffness along a rotating crack over that across it, at most; not where it is pressed by more than its strength
   real(wp), parameter :: most_contrast = 10.0_wp

   !> Least part of its strength that shear leaves a crack of bedded masonry
   real(wp), parameter :: least_share = 0.2_wp
   !> Into how many steps that part is rounded
   real(wp), parameter :: share_steps = 1.0e6_wp

   !> Strengths along the bed joints over those across them, see the head of this module
   type :: bedding
      real(wp) :: angle = 0.0_wp       !! of the bed joints to x [rad]
      real(wp) :: strength = 0.0_wp    !! tensile strength, 0: masonry without joints, isotropic
      real(wp) :: energy = 0.0_wp      !! fracture energy
      real(wp) :: shear = 1.0_wp       !! sqrt(a), at least 1
      real(wp) :: width = 0.0_wp       !! crack band, 0 the element's across the crack [m]
   end type bedding

   type, extends(point_group) :: plane_group
      type(element_rule) :: rule
      logical :: selective = .false.                     !! shear strain from the element's middle
      real(wp), allocatable :: gradient(:, :, :)         !! (2, nodes, points) [1/m]
      real(wp), allocatable :: shear_gradient(:, :, :)   !! (2, nodes, elements), if selective
      real(wp), allocatable :: weight(:)                 !! volume of a point [m^3]
      real(wp), allocatable :: young(:)                  !! (elements) [Pa]
      real(wp), allocatable :: nu(:)
      integer(c_int), allocatable :: table(:)            !! tension teeth, 0 none
      integer(c_int), allocatable :: ladder(:, :)        !! (2, elements) tables of narrowest and widest band, 0 none
      real(wp), allocatable :: diagonal(:, :, :)         !! (2, 2, elements), two sides of triangles [m]
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
      procedure :: matrix
      procedure :: force
      procedure :: scan
      procedure :: damage
      procedure :: report
      procedure :: state
      procedure :: margin
      procedure :: refresh
      procedure :: table_of
   end type plane_group

contains

   !> A group of one element kind; the damage is set to none
   subroutine plane_group_new(kind, nx, ny, selective, xy, connect, thickness, young, nu, tables, crush_table, &
                              lateral, confinement, axis, axis_angle, bed, teeth, options, group, bad, status)
      integer(c_int), intent(in) :: kind            !! of the list sla_element
      integer(c_int), intent(in) :: nx              !! Gauss points of quadrilaterals
      integer(c_int), intent(in) :: ny
      logical, intent(in) :: selective
      real(wp), intent(in) :: xy(:, :)              !! (2, nodes) [m]
      integer(c_int), intent(in) :: connect(:, :)   !! (nodes of an element, elements), 1-based
      real(wp), intent(in) :: thickness(:)          !! [m]
      real(wp), intent(in) :: young(:)              !! [Pa]
      real(wp), intent(in) :: nu(:)
      integer(c_int), intent(in) :: tables(:, :)    !! (3, elements) of uncracked points, of narrowest and widest band
      integer(c_int), intent(in) :: crush_table(:)
      real(wp), intent(in) :: lateral(:)            !! [Pa]
      real(wp), intent(in) :: confinement(:)
      integer(c_int), intent(in) :: axis(:)         !! 0 cracks choose, 1 one normal given, 2 also the shear is kept
      real(wp), intent(in) :: axis_angle(:)         !! of the crack normal [rad]
      real(wp), intent(in) :: bed(:, :)             !! (5, elements) the components of `bedding` in their order
      type(tooth_tables), intent(in) :: teeth
      type(material_options), intent(in) :: options
      type(plane_group), intent(out) :: group
      integer(c_int), intent(out) :: bad            !! the offending element, 1-based
      integer(c_int), intent(out) :: status
      integer :: e, k, p, ne, per, info
      real(wp) :: area(most_points), middle(2, most_nodes), corner(2, most_nodes)

      bad = 0
      call element_rule_new(kind, nx, ny, group%rule, status)
      if (status /= status_ok) return
      if (selective .and. kind /= element_q4) then
         status = status_invalid_argument
         return
      end if
      ne = size(connect, 2)
      per = group%rule%points
      group%elements = ne
      group%points = ne * per
      group%freedoms = 2 * group%rule%nodes
      group%selective = selective
      group%options = options
      call tooth_tables_copy(teeth, group%teeth, status)
      if (status /= status_ok) return
      allocate (group%gradient(2, group%rule%nodes, group%points), group%weight(group%points), &
         group%shear_gradient(2, group%rule%nodes, merge(ne, 0, selective)), &
         group%young(ne), group%nu(ne), group%table(ne), group%crush_table(ne), group%lateral(ne), group%axis(ne), &
         group%ladder(2, ne), group%diagonal(2, 2, ne), group%confinement(ne), group%bed(ne), &
         group%pair(2, merge(group%points, 0, any(bed(2, :) > 0.0_wp))), &
         group%turn(2, group%points), group%cracked(group%points), group%tooth(2, group%points), &
         group%crush(2, group%points), group%shut(2, group%points), group%changes(2, group%points), &
         group%stiff(4, group%points), group%limit(4, group%points), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      group%young(:) = young
      group%nu(:) = nu
      group%table(:) = tables(1, :)
      group%ladder(:, :) = tables(2:3, :)
      group%crush_table(:) = crush_table
      group%lateral(:) = lateral
      group%confinement(:) = confinement
      group%axis(:) = axis
      group%pair = 0
      do e = 1, ne
         group%bed(e) = bedding(bed(1, e), bed(2, e), bed(3, e), bed(4, e), bed(5, e))
         p = per * (e - 1)
         do k = 1, size(connect, 1)   ! a list of columns as an argument would be a copy that nobody checks
            corner(:, k) = xy(:, connect(k, e))
         end do
         call element_gradients(group%rule, corner(:, 1:size(connect, 1)), group%gradient(:, :, p + 1:p + per), area, &
            middle(:, 1:group%rule%nodes), status)
         if (status /= status_ok) then
            bad = int(e, c_int)
            return
         end if
         if (selective) group%shear_gradient(:, :, e) = middle(:, 1:group%rule%nodes)
         group%diagonal(:, 1, e) = xy(:, connect(3, e)) - xy(:, connect(1, e))
         group%diagonal(:, 2, e) = xy(:, connect(2, e)) - xy(:, connect(1, e))
         if (.not. is_triangle(group)) group%diagonal(:, 2, e) = xy(:, connect(4, e)) - xy(:, connect(2, e))
         group%weight(p + 1:p + per) = area(1:per) * thickness(e)
         do k = p + 1, p + per
            group%turn(:, k) = [1.0_wp, 0.0_wp]
            if (axis(e) /= axis_free) group%turn(:, k) = [cos(axis_angle(e)), sin(axis_angle(e))]
            group%cracked(k) = merge(1_c_int, 0_c_int, axis(e) /= axis_free)
            if (group%cracked(k) /= 0 .and. is_bedded(group, e)) call set_pair(group, e, k)
         end do
      end do
      group%tooth = 1
      group%crush = 1
      group%shut = 0
      group%changes = 0
      do k = 1, group%points
         call group%refresh(k)
      end do
   end subroutine plane_group_new

   !> Stiffness (thesis Eqs 4.9 to 4.11) and strengths of a point from its damage
   pure subroutine refresh(group, p)
      class(plane_group), intent(inout) :: group
      integer, intent(in) :: p
      integer :: e, k
      real(wp) :: e0, nu, modulus(2), tension, compression, ratio, least

      e = (p - 1) / group%rule%points + 1
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
   end subroutine refresh

   !> Strain at a point from its element's displacements, in the crack axes
   pure function strain_at(group, e, p, local) result(eps)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: local(:)
      real(wp) :: eps(3), x, y, g, c, s
      integer :: i

      x = 0.0_wp
      y = 0.0_wp
      g = 0.0_wp
      do i = 1, group%rule%nodes
         x = x + group%gradient(1, i, p) * local(2 * i - 1)
         y = y + group%gradient(2, i, p) * local(2 * i)
         g = g + group%gradient(2, i, p) * local(2 * i - 1) + group%gradient(1, i, p) * local(2 * i)
      end do
      if (group%selective) then
         g = 0.0_wp
         do i = 1, group%rule%nodes
            g = g + group%shear_gradient(2, i, e) * local(2 * i - 1) + group%shear_gradient(1, i, e) * local(2 * i)
         end do
      end if
      if (group%cracked(p) == 0) then
         eps = [x, y, g]
      else
         c = group%turn(1, p)
         s = group%turn(2, p)
         eps = [c**2 * x + s**2 * y + c * s * g, s**2 * x + c**2 * y - c * s * g, &
            2.0_wp * c * s * (y - x) + (c**2 - s**2) * g]
      end if
   end function strain_at

   !> Stress from strain, both in the crack axes [Pa]
   pure function stress_at(group, p, eps) result(sigma)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: p
      real(wp), intent(in) :: eps(3)
      real(wp) :: sigma(3)
      sigma = [group%stiff(1, p) * eps(1) + group%stiff(2, p) * eps(2), &
         group%stiff(2, p) * eps(1) + group%stiff(3, p) * eps(2), group%stiff(4, p) * eps(3)]
   end function stress_at

   !> B' R' v: nodal forces of a unit volume under the stress v in the crack axes
   pure subroutine nodal(group, e, p, v, local)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: v(3)
      real(wp), intent(out) :: local(:)
      real(wp) :: c, s, x, y, t
      integer :: i

      c = group%turn(1, p)
      s = group%turn(2, p)
      if (group%cracked(p) == 0) then
         c = 1.0_wp
         s = 0.0_wp
      end if
      x = c**2 * v(1) + s**2 * v(2) - 2.0_wp * c * s * v(3)
      y = s**2 * v(1) + c**2 * v(2) + 2.0_wp * c * s * v(3)
      t = c * s * (v(1) - v(2)) + (c**2 - s**2) * v(3)
      do i = 1, group%rule%nodes
         if (group%selective) then
            local(2 * i - 1) = group%gradient(1, i, p) * x + group%shear_gradient(2, i, e) * t
            local(2 * i) = group%gradient(2, i, p) * y + group%shear_gradient(1, i, e) * t
         else
            local(2 * i - 1) = group%gradient(1, i, p) * x + group%gradient(2, i, p) * t
            local(2 * i) = group%gradient(2, i, p) * y + group%gradient(1, i, p) * t
         end if
      end do
   end subroutine nodal

   pure subroutine matrix(group, element, k)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: element
      real(wp), intent(out) :: k(:, :)
      real(wp) :: b(2 * most_nodes, 3), db(2 * most_nodes, 3)
      integer :: p, i, n

      n = group%freedoms
      k = 0.0_wp
      do p = (element - 1) * group%rule%points + 1, element * group%rule%points
         call nodal(group, element, p, [1.0_wp, 0.0_wp, 0.0_wp], b(1:n, 1))
         call nodal(group, element, p, [0.0_wp, 1.0_wp, 0.0_wp], b(1:n, 2))
         call nodal(group, element, p, [0.0_wp, 0.0_wp, 1.0_wp], b(1:n, 3))
         db(1:n, 1) = group%weight(p) * (group%stiff(1, p) * b(1:n, 1) + group%stiff(2, p) * b(1:n, 2))
         db(1:n, 2) = group%weight(p) * (group%stiff(2, p) * b(1:n, 1) + group%stiff(3, p) * b(1:n, 2))
         db(1:n, 3) = group%weight(p) * group%stiff(4, p) * b(1:n, 3)
         do i = 1, n
            k(1:n, i) = k(1:n, i) + b(1:n, 1) * db(i, 1) + b(1:n, 2) * db(i, 2) + b(1:n, 3) * db(i, 3)
         end do
      end do
   end subroutine matrix

   pure subroutine force(group, u, f)
      class(plane_group), intent(in) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: f(0:)
      real(wp) :: local(2 * most_nodes), part(2 * most_nodes)
      integer :: e, p, i

      do e = 1, group%elements
         call group%gather(e, u, local)
         do p = (e - 1) * group%rule%points + 1, e * group%rule%points
            call nodal(group, e, p, group%weight(p) * stress_at(group, p, strain_at(group, e, p, local)), part)
            do i = 1, group%freedoms
               f(group%equation(i, e)) = f(group%equation(i, e)) + part(i) * group%factor(i, e)
            end do
         end do
      end do
   end subroutine force

   pure subroutine scan(group, first, last, ua, ub, lambda, noise, found)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      type(scan_result), intent(inout) :: found
      real(wp) :: la(2 * most_nodes), lb(2 * most_nodes), sa(3), sb(3)
      logical :: simple
      integer :: e, p, i

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
         simple = group%table(e) /= 0 .and. group%crush_table(e) == 0 .and. group%lateral(e) <= 0.0_wp .and. &
            .not. is_bedded(group, e)
         do p = (e - 1) * group%rule%points + 1, e * group%rule%points
            sa = stress_at(group, p, strain_at(group, e, p, la))
            sb = stress_at(group, p, strain_at(group, e, p, lb))
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
      class(plane_group), intent(in) :: group
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
            call cone(f, 1.0_wp, in_joint_axes(group%bed(e), sa, f), in_joint_axes(group%bed(e), sb, 0.0_wp), lambda, &
               noise, p, code_tension, found)
         else if (f < unbounded) then
            call cone(f, 1.0_wp, sa, sb, lambda, noise, p, code_tension, found)
            fc = group%lateral(e)
            if (fc > 0.0_wp) call cone(f * fc / (f + fc), (fc - f) / (fc + f), sa, sb, lambda, noise, p, &
               code_tension, found)
         end if
         f = group%limit(3, p)
         more = group%confinement(e)
         if (f < unbounded) call cone(f / (1.0_wp + more), (more - 1.0_wp) / (more + 1.0_wp), sa, sb, lambda, noise, &
            p, code_compression + 1, found)
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

   !> See point_group: the same limits as scan_point
   pure subroutine margin(group, first, last, ua, ub, lambda, least)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: least(:)
      real(wp) :: la(2 * most_nodes), lb(2 * most_nodes), sa(3), sb(3), share, f, fc
      integer :: e, p, k

      do e = first, last
         if (group%table(e) == 0 .and. group%crush_table(e) == 0) cycle
         ! Both have no bound yet: crushing that depends on both principal stresses, and the criterion of another stress
         if (group%confinement(e) > 0.0_wp .or. is_bedded(group, e)) then
            least = -1.0_wp
            return
         end if
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         do p = (e - 1) * group%rule%points + 1, e * group%rule%points
            sa = stress_at(group, p, strain_at(group, e, p, la))
            sb = stress_at(group, p, strain_at(group, e, p, lb))
            if (group%cracked(p) == 0 .or. (group%options%cracking == isotropic .and. &
                group%axis(e) == axis_free)) then
               share = sqrt(group%weight(p) / group%stiff(1, p))
               f = group%limit(1, p)
               if (f < unbounded) then
                  call lower(f, 1.0_wp, sa, sb, share, lambda, least)
                  fc = group%lateral(e)
                  if (fc > 0.0_wp) call lower(f * fc / (f + fc), (fc - f) / (fc + f), sa, sb, share, lambda, least)
               end if
               f = group%limit(3, p)
               if (f < unbounded) call lower(f, -1.0_wp, sa, sb, share, lambda, least)
               cycle
            end if
            do k = 1, merge(1, 2, group%axis(e) /= axis_free)
               share = sqrt(group%weight(p) / group%stiff(2 * k - 1, p))
               f = group%limit(k, p)
               if (f < unbounded) least = min(least, share * (f - sa(k) - lambda * sb(k)))
               fc = group%limit(k + 2, p)
               if (fc < unbounded) least = min(least, share * (fc + sa(k) + lambda * sb(k)))
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
   pure subroutine lower(alpha, beta, sa, sb, share, lambda, least)
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
   end subroutine lower

   !> Does the strength of an element depend on the direction to its bed joints?
   pure function is_bedded(group, e) result(yes)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e
      logical :: yes
      yes = group%bed(e)%strength > 0.0_wp
   end function is_bedded

   !> The stress in the axes of the joints whose isotropic criterion with the strength f is that of bedded masonry; of
   !> the change of a stress where f is 0
   pure function in_joint_axes(bed, s, f) result(image)
      type(bedding), intent(in) :: bed
      real(wp), intent(in) :: s(3)     !! sx, sy, txy [Pa]
      real(wp), intent(in) :: f        !! strength across the bed joints [Pa]
      real(wp) :: image(3), m, c, s2, d
      m = 0.5_wp * (s(1) + s(2))
      c = cos(2.0_wp * bed%angle)
      s2 = sin(2.0_wp * bed%angle)
      d = 0.5_wp * (s(1) - s(2)) * c + s(3) * s2
      image = [m + d + f * (1.0_wp - bed%strength), m - d, bed%shear * (s(3) * c - 0.5_wp * (s(1) - s(2)) * s2)]
   end function in_joint_axes

   !> Limits of an uncracked point under one criterion
   pure subroutine cone(alpha, beta, sa, sb, lambda, noise, p, code, found)
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
   end subroutine cone

   !> True where the stress lies safely inside r <= alpha - beta m; in this module so that it is inlined
   pure function inside_cone(alpha, beta, s) result(inside)
      real(wp), intent(in) :: alpha, beta
      real(wp), intent(in) :: s(3)    !! sx, sy, txy [Pa]
      logical :: inside
      real(wp) :: margin
      margin = alpha - beta * 0.5_wp * (s(1) + s(2))
      inside = margin >= 0.0_wp .and. margin**2 >= 0.25_wp * (s(1) - s(2))**2 + s(3)**2
   end function inside_cone

   pure subroutine damage(group, point, code, lambda, ua, ub, event, tooth)
      class(plane_group), intent(inout) :: group
      integer, intent(in) :: point
      integer, intent(in) :: code
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      type(event_vectors), intent(out) :: event
      integer, intent(out) :: tooth
      real(wp), parameter :: right_angle = 0.5_wp * acos(-1.0_wp)
      real(wp) :: la(2 * most_nodes), lb(2 * most_nodes), s(3), v(3), old(4), phi, delta, pressed
      real(wp) :: before, after, alpha, change
      logical :: turns, follows
      integer :: e, k, p, sense

      p = point
      e = (p - 1) / group%rule%points + 1
      k = 1 + mod(code - 1, 2)
      sense = code - k + 1
      turns = sense == code_tension .and. group%options%cracking == rotating .and. group%axis(e) == axis_free
      call group%gather(e, ua, la)
      call group%gather(e, ub, lb)
      la(1:group%freedoms) = la(1:group%freedoms) + lambda * lb(1:group%freedoms)
      delta = 0.0_wp
      if (group%cracked(p) == 0) then
         s = stress_at(group, p, strain_at(group, e, p, la))
         if (is_bedded(group, e)) then
            call open_bedded(group, e, p, s, sense == code_tension)
         else
            phi = 0.5_wp * atan2(2.0_wp * s(3), s(1) - s(2))     ! thesis Eq. 4.7
            group%turn(:, p) = [cos(phi), sin(phi)]
            group%cracked(p) = 1
         end if
         call set_band(group, e, p)
      else if (turns) then
         s = strain_at(group, e, p, la)
         delta = 0.5_wp * atan2(s(3), s(1) - s(2))
         delta = delta - right_angle * anint(delta / right_angle)   ! to the nearer of both principal directions
         if (abs(delta) < least_turn) delta = 0.0_wp
      end if
      old = group%stiff(:, p)
      before = direction_modulus(group, e, p, k)
      if (delta /= 0.0_wp) then
         group%turn(:, p) = [cos(delta) * group%turn(1, p) - sin(delta) * group%turn(2, p), &
            sin(delta) * group%turn(1, p) + cos(delta) * group%turn(2, p)]
         call set_band(group, e, p)
      end if
      select case (sense)
      case (code_tension)
         group%tooth(k, p) = group%tooth(k, p) + 1_c_int
      case (code_compression)
         group%crush(k, p) = group%crush(k, p) + 1_c_int
      case (code_close)
         group%shut(k, p) = 1
         group%changes(k, p) = group%changes(k, p) + 1_c_int
      case default
         group%shut(k, p) = 0
         group%changes(k, p) = group%changes(k, p) + 1_c_int
      end select
      tooth = int(merge(group%crush(k, p), group%tooth(k, p), sense == code_compression))
      if (group%options%cracking == isotropic) then
         group%tooth(2, p) = group%tooth(1, p)
         group%crush(1, p) = maxval(group%crush(:, p))
         group%crush(2, p) = group%crush(1, p)
      end if
      follows = .false.
      if (turns) then
         call group%refresh(p)
         s = stress_at(group, p, strain_at(group, e, p, la))
         pressed = 0.0_wp
         if (.not. group%options%closure) pressed = &
            group%teeth%strength_of(group%table_of(e, p, 3 - k), 1_c_int, share_of(group, e, p, 3 - k))
         if (s(3 - k) > -pressed) call follow(group, e, p, k, follows)
      end if
      after = direction_modulus(group, e, p, k)
      call group%refresh(p)

      if (group%options%cracking == isotropic) then
         ! All of D changes in proportion: the Cholesky factor of the change, three vectors.
         change = (1.0_wp - after / before) * group%weight(p)
         v = [sqrt(old(1)), old(2) / sqrt(old(1)), 0.0_wp]
         call add_vector(group, e, p, v, change, event)
         call add_vector(group, e, p, [0.0_wp, sqrt(old(3) - v(2)**2), 0.0_wp], change, event)
         call add_vector(group, e, p, [0.0_wp, 0.0_wp, sqrt(old(4))], change, event)
      else if (delta /= 0.0_wp .or. follows) then
         call add_change(group, e, p, old, delta, event)
      else
         if (before /= after) then
            alpha = 1.0_wp / (1.0_wp / (1.0_wp / after - 1.0_wp / before) + merge(old(1), old(3), k == 1))
            v = [merge(old(1), old(2), k == 1), merge(old(2), old(3), k == 1), 0.0_wp]
            call add_vector(group, e, p, v, alpha * group%weight(p), event)
         end if
         change = old(4) - group%stiff(4, p)
         if (abs(change) > 1.0e-14_wp * old(4)) then
            call add_vector(group, e, p, [0.0_wp, 0.0_wp, 1.0_wp], change * group%weight(p), event)
         end if
      end if

   end subroutine damage

   !> The first crack of bedded masonry: its direction, and the share of the interpolated strength it opens at
   pure subroutine open_bedded(group, e, p, s, cracks)
      class(plane_group), intent(inout) :: group
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
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e, p, k
      real(wp) :: share
      share = 1.0_wp
      if (group%cracked(p) == 0 .or. .not. is_bedded(group, e)) return
      share = between(group, e, p, k, group%bed(e)%strength) * kept(group, p, k)
   end function share_of

   !> A property across one crack direction, over that across the bed joints
   pure function between(group, e, p, k, along) result(ratio)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e, p, k
      real(wp), intent(in) :: along    !! the same along the bed joints
      real(wp) :: ratio, n(2)
      n = group%turn(:, p)
      if (k == 2) n = [-n(2), n(1)]
      ratio = 1.0_wp + (along - 1.0_wp) * (n(1) * cos(group%bed(e)%angle) + n(2) * sin(group%bed(e)%angle))**2
   end function between

   !> What shear has left of the strength of a crack
   pure function kept(group, p, k) result(part)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: p, k
      real(wp) :: part
      part = 1.0_wp
      if (k == 1) part = 1.0_wp - real(group%cracked(p) - 1, wp) / share_steps
   end function kept

   !> The tables of both cracks of bedded masonry
   pure subroutine set_pair(group, e, p)
      class(plane_group), intent(inout) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp) :: stretch
      integer :: k
      do k = 1, 2
         stretch = kept(group, p, k) * between(group, e, p, k, group%bed(e)%strength)**2 &
            / between(group, e, p, k, group%bed(e)%energy)
         group%pair(k, p) = group%teeth%nearest_band(group%ladder(1, e), group%ladder(2, e), &
            stretch * width_across(group, e, group%turn(:, p)))
      end do
   end subroutine set_pair

   !> The crack band across the crack axes; teeth that were passed become those of as much stiffness
   pure subroutine set_band(group, e, p)
      class(plane_group), intent(inout) :: group
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

   !> Teeth of the other direction, so that it is not much stiffer than that of crack k
   pure subroutine follow(group, e, p, k, follows)
      class(plane_group), intent(inout) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      integer, intent(in) :: k
      logical, intent(out) :: follows      !! the other direction has lost teeth
      real(wp) :: most
      integer :: other
      other = 3 - k
      most = most_contrast * direction_modulus(group, e, p, k)
      follows = .false.
      do while (group%tooth(other, p) < group%tooth(k, p))
         if (direction_modulus(group, e, p, other) <= most) exit
         group%tooth(other, p) = group%tooth(other, p) + 1_c_int
         follows = .true.
      end do
   end subroutine follow

   !> The vectors of a change of the stiffness and of the axes, up to three, some of which may stiffen
   pure subroutine add_change(group, e, p, old, delta, event)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: old(4)       !! stiffness in the old axes [Pa]
      real(wp), intent(in) :: delta        !! angle from the old axes to the new ones [rad]
      type(event_vectors), intent(inout) :: event
      real(wp) :: c, s, r(3, 3), d(3, 3), vectors(3, 3), least
      integer :: i

      c = cos(delta)
      s = -sin(delta)
      r(1, :) = [c**2, s**2, c * s]
      r(2, :) = [s**2, c**2, -c * s]
      r(3, :) = [-2.0_wp * c * s, 2.0_wp * c * s, c**2 - s**2]
      d = stiffness_matrix(old)
      d = matmul(d, r)
      d = matmul(transpose(r), d)
      d = d - stiffness_matrix(group%stiff(:, p))
      call principal(d, vectors)
      least = 1.0e-14_wp * maxval(old)
      do i = 1, 3    ! stiffening first: the small system of the event then has no small pivot, see sla_events
         if (d(i, i) < -least) call add_vector(group, e, p, vectors(:, i), d(i, i) * group%weight(p), event)
      end do
      do i = 1, 3
         if (d(i, i) > least) call add_vector(group, e, p, vectors(:, i), d(i, i) * group%weight(p), event)
      end do
   end subroutine add_change

   !> Dnn, Dns, Dss, G as a matrix
   pure function stiffness_matrix(stiff) result(d)
      real(wp), intent(in) :: stiff(4)
      real(wp) :: d(3, 3)
      d = 0.0_wp
      d(1:2, 1) = stiff(1:2)
      d(1:2, 2) = stiff(2:3)
      d(3, 3) = stiff(4)
   end function stiffness_matrix

   !> Eigenvalues, left on the diagonal, and eigenvectors of a symmetric matrix by Jacobi's rotations
   pure subroutine principal(d, vectors)
      real(wp), intent(inout) :: d(3, 3)
      real(wp), intent(out) :: vectors(3, 3)   !! columns of unit length
      real(wp) :: size, theta, t, c, s, row(3)
      integer :: sweep, i, j
      vectors = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      size = maxval(abs(d))
      do sweep = 1, 20    ! converges quadratically: five are enough
         do i = 1, 2
            do j = i + 1, 3
               if (abs(d(i, j)) <= 1.0e-16_wp * size) cycle
               theta = (d(j, j) - d(i, i)) / (2.0_wp * d(i, j))
               t = sign(1.0_wp, theta) / (abs(theta) + sqrt(theta**2 + 1.0_wp))
               c = 1.0_wp / sqrt(t**2 + 1.0_wp)
               s = t * c
               row = d(i, :)
               d(i, :) = c * row - s * d(j, :)
               d(j, :) = s * row + c * d(j, :)
               row = d(:, i)
               d(:, i) = c * row - s * d(:, j)
               d(:, j) = s * row + c * d(:, j)
               row = vectors(:, i)
               vectors(:, i) = c * row - s * vectors(:, j)
               vectors(:, j) = s * row + c * vectors(:, j)
            end do
         end do
         if (max(abs(d(1, 2)), abs(d(1, 3)), abs(d(2, 3))) <= 1.0e-15_wp * size) exit
      end do
   end subroutine principal

   !> Table of a point's tension teeth: of its element's until it cracks, then of its crack band
   pure function table_of(group, e, p, k) result(table)
      class(plane_group), intent(in) :: group
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

   !> Crack band of a crack of the normal n: the element's width across it, see the head of this module [m]
   pure function width_across(group, e, n) result(width)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: n(2)
      real(wp) :: width, a(2), b(2), along(2), across(2)
      width = group%bed(e)%width
      if (width > 0.0_wp) return
      a = group%diagonal(:, 1, e)
      b = group%diagonal(:, 2, e)
      along = [a(2) * n(1) - a(1) * n(2), b(2) * n(1) - b(1) * n(2)]
      if (is_triangle(group)) then
         across = [dot_product(a, n), dot_product(b, n)]
         width = max(0.0_wp, maxval(across)) - min(0.0_wp, minval(across))
      else
         width = abs(a(1) * b(2) - a(2) * b(1)) / sum(abs(along))
      end if
   end function width_across

   pure function is_triangle(group) result(yes)
      class(plane_group), intent(in) :: group
      logical :: yes
      yes = group%rule%kind == element_t3 .or. group%rule%kind == element_t6
   end function is_triangle

   !> One more vector sqrt(|size|) B' R' v, softening where size > 0
   pure subroutine add_vector(group, e, p, v, size, event)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: v(3)           !! stress in the crack axes
      real(wp), intent(in) :: size
      type(event_vectors), intent(inout) :: event
      real(wp) :: local(2 * most_nodes)
      event%rank = event%rank + 1
      event%sign(event%rank) = sign(1.0_wp, size)
      call nodal(group, e, p, sqrt(abs(size)) * v, local)
      call group%spread(e, local, event, event%rank)
   end subroutine add_vector

   pure subroutine state(group, store, values)
      class(plane_group), intent(inout) :: group
      logical, intent(in) :: store
      real(wp), intent(inout) :: values(:, :)
      integer :: e, p
      if (store) then
         values(1:2, :) = group%turn
         values(3, :) = real(group%cracked, wp)
         values(4:5, :) = real(group%tooth, wp)
         values(6:7, :) = real(group%crush, wp)
         values(8:9, :) = real(group%shut, wp)
         values(10:11, :) = real(group%changes, wp)
      else
         group%turn(:, :) = values(1:2, :)
         group%cracked(:) = nint(values(3, :), c_int)
         group%tooth(:, :) = nint(values(4:5, :), c_int)
         group%crush(:, :) = nint(values(6:7, :), c_int)
         group%shut(:, :) = nint(values(8:9, :), c_int)
         group%changes(:, :) = nint(values(10:11, :), c_int)
         do p = 1, group%points
            e = (p - 1) / group%rule%points + 1
            if (is_bedded(group, e) .and. group%cracked(p) > 0) call set_pair(group, e, p)
            call group%refresh(p)
         end do
      end if
   end subroutine state

   !> Secant modulus of one crack direction [Pa]
   pure function direction_modulus(group, e, p, k) result(modulus)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e, p, k
      real(wp) :: modulus
      modulus = group%teeth%modulus_of(group%crush_table(e), group%crush(k, p), group%young(e), group%options%floor)
      if (group%shut(k, p) == 0) modulus = min(modulus, &
         group%teeth%modulus_of(group%table_of(e, p, k), group%tooth(k, p), group%young(e), group%options%floor))
   end function direction_modulus

   !> Rows: 1-3 strain and 4-6 stress in the crack axes, 7-8 cosine and sine of the first crack's normal,
   !> 9-10 moduli over the initial one, 11-12 tension teeth, 13-14 admitted range of lambda, 15 volume,
   !> 16-17 compression teeth, 18 shut (1 first, 2 second direction, 3 both),
   !> 19 crack band [m]
   pure subroutine report(group, ua, ub, lambda, noise, values)
      class(plane_group), intent(in) :: group
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      real(wp), intent(out) :: values(:, :)     !! (report_rows, points)
      real(wp) :: la(2 * most_nodes), lb(2 * most_nodes), ea(3), eb(3)
      type(scan_result) :: found
      integer :: e, p, k

      do e = 1, group%elements
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         do p = (e - 1) * group%rule%points + 1, e * group%rule%points
            ea = strain_at(group, e, p, la)
            eb = strain_at(group, e, p, lb)
            values(1:3, p) = ea + lambda * eb
            values(4:6, p) = stress_at(group, p, ea + lambda * eb)
            values(7:8, p) = group%turn(:, p)
            values(9, p) = direction_modulus(group, e, p, 1) / group%young(e)
            k = merge(1, 2, group%options%cracking == isotropic)
            values(10, p) = direction_modulus(group, e, p, k) / group%young(e)
            values(11:12, p) = real(group%tooth(:, p), wp)
            found = scan_result()
            call scan_point(group, e, p, stress_at(group, p, ea), stress_at(group, p, eb), lambda, noise, found)
            values(13:14, p) = [found%lo%value, found%hi%value]
            if (found%empty%point /= 0) values(13:14, p) = [unbounded, -unbounded]
            values(15, p) = group%weight(p)
            values(16:17, p) = real(group%crush(:, p), wp)
            values(18, p) = real(group%shut(1, p) + 2 * group%shut(2, p), wp)
            values(19, p) = 0.0_wp
            if (group%table(e) /= 0) values(19, p) = group%teeth%band(group%table_of(e, p, 1))
            if (is_bedded(group, e) .and. group%cracked(p) > 0) values(19, p) = &
               width_across(group, e, group%turn(:, p))
         end do
      end do
   end subroutine report

end module sla_plane
