!> Flat shells of layers that crack, crush, open and close as plane-stress points do.
!>
!> The strain of a layer is that of the membrane plus its height times the curvature; the law of a layer's point is that
!> of sla_plane_points. Beside it a crack softens the transverse shear across itself (thesis Eq. 4.15): the cracks of a
!> point stand upright on the shell. A tooth changes the stiffness by rank three: the modulus across the crack, the
!> shear modulus in the plane and the transverse one.
!>
!> In equilibrium iterations the transverse shear is linear within a step, t = A (g - s), and A follows the cracks in the
!> state at its end. Where a crack opens its stress falls. Where one closes, the stress stays and the slip s moves: a
!> crack that closes brings no energy.
!>
!> Nodes have six freedoms: displacements along x, y, z and rotations about three axes of their own, the third of which
!> is held where the shell is flat: rotations about the normal have no stiffness there and need none.
module shell_group
   use common_jacobi, only : principal
   use common_kinds, only : wp
   use common_lists, only : isotropic => sla_cracking_isotropic
   use common_status, only : status_ok, status_out_of_memory
   use shell_element, only : shell_geometry, shell_geometry_new, shell_rule_new, shear_share, most_corners
   use shell_layers, only : layers_new, most_layers
   use sla_element, only : most_points
   use sla_group, only : event_vectors, material_options, most_entries
   use sla_plane_damage, only : plane_damage, damage_point
   use sla_plane_history, only : begin_plane, respond_elastic, respond_plane, set_elastic, show_plane, update_plane
   use sla_plane_points, only : points_new, points_ready, direction_modulus, refresh_plane, axis_joint
   use sla_tables, only : tooth_tables
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: shell_points, shell_points_new, shell_section

   !> Stiffness of the tie between the rotation about the normal and that of the membrane, over the shear modulus: any
   !> converges (Hughes and Brezzi 1989); little of it leaves the membrane as it is
   real(wp), parameter :: drilling = 1.0e-2_wp

   !> Rows of a point's history: those of its law, transverse slip and shear moduli xx, yy, xy in the axes of the element
   integer, parameter :: all_rows = 7, slip_x = 3, slip_y = 4, shear_xx = 5, shear_yy = 6, shear_xy = 7

   !> How shells are integrated
   type :: shell_section
      integer(c_int) :: through = 1        !! of the list shell_through
      integer(c_int) :: layers = 1
      logical :: bends = .true.            !! without it a membrane: one layer, no rotations
   end type shell_section

   type, extends(plane_damage) :: shell_points
      type(shell_section) :: section
      real(wp) :: height(most_layers) = 0.0_wp           !! of the layers over the middle, in thicknesses
      real(wp) :: share(most_layers) = 0.0_wp            !! of the thickness
      real(wp), allocatable :: thickness(:)              !! (elements) [m]
      real(wp), allocatable :: axes(:, :, :)             !! (3, 3, elements) rows: x, y, normal
      real(wp), allocatable :: turned(:, :, :, :)        !! (3, 3, nodes, elements) rotations per node's
      real(wp), allocatable :: arm(:, :)                 !! (nodes, elements) height of the nodes [m]
      real(wp), allocatable :: slope(:, :, :, :)         !! (2, nodes, in the plane, elements) of shape functions [1/m]
      real(wp), allocatable :: middle(:, :, :)           !! (2, nodes, elements) the same in the middle
      real(wp), allocatable :: bend(:, :, :, :)          !! (3, 3 nodes, in the plane, elements), see shell_element
      real(wp), allocatable :: shear(:, :, :, :)         !! (2, 3 nodes, in the plane, elements)
      real(wp), allocatable :: tie(:, :)                 !! (nodes, elements) of rotations about the normal [N m]
      real(wp), allocatable :: transverse(:, :)          !! (2, points) shear moduli across both cracks [Pa]
   contains
      procedure :: strains
      procedure :: nodal
      procedure :: matrix
      procedure :: force
      procedure :: damage
      procedure :: refresh
      procedure :: begin
      procedure :: extrapolate
      procedure :: respond
      procedure :: update
   end type shell_points

contains

   !> A group of shells of one kind; the damage is set to none
   subroutine shell_points_new(kind, section, selective, xyz, frame, flat, connect, property, choice, teeth, options, &
                               group, bad, status)
      integer(c_int), intent(in) :: kind            !! Q4 or T3 of the list sla_element
      type(shell_section), intent(in) :: section
      logical, intent(in) :: selective              !! in-plane shear strain of quadrilaterals from the middle
      real(wp), intent(in) :: xyz(:, :)             !! (3, nodes) [m]
      real(wp), intent(in) :: frame(:, :, :)        !! (3, 3, nodes) columns: axes of a node's rotations
      integer(c_int), intent(in) :: flat(:)         !! (nodes) 1: the shell is flat there, see above
      integer(c_int), intent(in) :: connect(:, :)   !! (nodes of an element, elements), 1-based
      real(wp), intent(in) :: property(:, :)        !! (14, elements) as of plane elements
      integer(c_int), intent(in) :: choice(:, :)    !! (5, elements) as of plane elements
      type(tooth_tables), intent(in) :: teeth
      type(material_options), intent(in) :: options
      type(shell_points), intent(inout) :: group
      integer(c_int), intent(out) :: bad            !! the offending element, 1-based
      integer(c_int), intent(out) :: status
      type(shell_geometry) :: geometry
      real(wp) :: corner(3, most_corners), area
      integer :: e, i, k, l, p, n, ne, info

      bad = 0
      group%section = section
      call shell_rule_new(kind, group%rule, status)
      if (status /= status_ok) return
      call layers_new(section%through, section%layers, group%height, group%share, status)
      if (status /= status_ok) return
      n = group%rule%nodes
      ne = size(connect, 2)
      group%elements = ne
      group%freedoms = 6 * n
      group%per = group%rule%points * int(section%layers)
      group%selective = selective .and. n == 4
      allocate (group%thickness(ne), group%axes(3, 3, ne), group%turned(3, 3, n, ne), group%arm(n, ne), &
         group%slope(2, n, group%rule%points, ne), group%middle(2, n, ne), group%tie(n, ne), &
         group%bend(3, 3 * n, group%rule%points, merge(ne, 0, section%bends)), &
         group%shear(2, 3 * n, group%rule%points, merge(ne, 0, section%bends)), &
         group%transverse(2, merge(ne * group%per, 0, section%bends)), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      call points_new(group, property, choice, teeth, options, status)
      if (status /= status_ok) return
      group%thickness(:) = property(1, :)
      do e = 1, ne
         do i = 1, n
            corner(:, i) = xyz(:, connect(i, e))
         end do
         call shell_geometry_new(group%rule, corner(:, 1:n), property(1, e), property(3, e), geometry, status)
         if (status /= status_ok) bad = int(e, c_int)
         if (status /= status_ok) return
         group%axes(:, :, e) = geometry%axes
         group%arm(:, e) = geometry%arm(1:n)
         group%middle(:, :, e) = geometry%middle(:, 1:n)
         do i = 1, n
            group%turned(:, :, i, e) = matmul(geometry%axes, frame(:, :, connect(i, e)))
         end do
         area = sum(geometry%area(1:group%rule%points))
         group%tie(:, e) = 0.0_wp
         do i = 1, n
            if (section%bends .and. flat(connect(i, e)) == 0) group%tie(i, e) = drilling * area * property(1, e) * &
               0.5_wp * property(2, e) / (1.0_wp + property(3, e)) / real(n, wp)
         end do
         group%diagonal(:, 1, e) = geometry%corner(:, 3) - geometry%corner(:, 1)
         group%diagonal(:, 2, e) = geometry%corner(:, 2) - geometry%corner(:, 1)
         group%side(:, e) = 0.0_wp
         if (n == 4) then
            group%side(:, e) = group%diagonal(:, 2, e)
            group%diagonal(:, 2, e) = geometry%corner(:, 4) - geometry%corner(:, 2)
         end if
         p = (e - 1) * group%per
         do k = 1, group%rule%points
            group%slope(:, :, k, e) = geometry%gradient(:, 1:n, k)
            if (section%bends) group%bend(:, :, k, e) = geometry%bend(:, 1:3 * n, k)
            if (section%bends) group%shear(:, :, k, e) = geometry%shear(:, 1:3 * n, k)
            do l = 1, int(section%layers)
               p = p + 1
               group%weight(p) = geometry%area(k) * property(1, e) * group%share(l)
            end do
         end do
      end do
      call points_ready(group)
   end subroutine shell_points_new

   !> Displacements of an element in its own axes, by node: u, v, w, rotations about x, y, z
   pure subroutine to_element(group, e, local, v)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      real(wp), intent(out) :: v(6, most_corners)
      integer :: i
      v = 0.0_wp
      do i = 1, group%rule%nodes
         v(1:3, i) = matmul(group%axes(:, :, e), local(6 * i - 5:6 * i - 3))
         v(4:6, i) = matmul(group%turned(:, :, i, e), local(6 * i - 2:6 * i))
         v(1, i) = v(1, i) - group%arm(i, e) * v(5, i)
         v(2, i) = v(2, i) + group%arm(i, e) * v(4, i)
      end do
   end subroutine to_element

   !> Forces of the nodes from those in the axes of the element
   pure subroutine from_element(group, e, f, local)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: f(6, most_corners)
      real(wp), intent(out) :: local(:)
      real(wp) :: moment(3)
      integer :: i
      do i = 1, group%rule%nodes
         moment = f(4:6, i) + group%arm(i, e) * [f(2, i), -f(1, i), 0.0_wp]
         local(6 * i - 5:6 * i - 3) = matmul(f(1:3, i), group%axes(:, :, e))
         local(6 * i - 2:6 * i) = matmul(moment, group%turned(:, :, i, e))
      end do
   end subroutine from_element

   !> Membrane strains at a point in the plane
   pure function membrane(group, e, k, v) result(eps)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e, k
      real(wp), intent(in) :: v(6, most_corners)
      real(wp) :: eps(3)
      integer :: i
      eps = 0.0_wp
      do i = 1, group%rule%nodes
         eps(1) = eps(1) + group%slope(1, i, k, e) * v(1, i)
         eps(2) = eps(2) + group%slope(2, i, k, e) * v(2, i)
         if (group%selective) then
            eps(3) = eps(3) + group%middle(2, i, e) * v(1, i) + group%middle(1, i, e) * v(2, i)
         else
            eps(3) = eps(3) + group%slope(2, i, k, e) * v(1, i) + group%slope(1, i, k, e) * v(2, i)
         end if
      end do
   end function membrane

   !> Nodal forces of membrane forces at a point in the plane are added to f
   pure subroutine add_membrane(group, e, k, s, f)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e, k
      real(wp), intent(in) :: s(3)
      real(wp), intent(inout) :: f(6, most_corners)
      integer :: i
      do i = 1, group%rule%nodes
         if (group%selective) then
            f(1, i) = f(1, i) + group%slope(1, i, k, e) * s(1) + group%middle(2, i, e) * s(3)
            f(2, i) = f(2, i) + group%slope(2, i, k, e) * s(2) + group%middle(1, i, e) * s(3)
         else
            f(1, i) = f(1, i) + group%slope(1, i, k, e) * s(1) + group%slope(2, i, k, e) * s(3)
            f(2, i) = f(2, i) + group%slope(2, i, k, e) * s(2) + group%slope(1, i, k, e) * s(3)
         end if
      end do
   end subroutine add_membrane

   !> Strains of all points of an element in its axes
   pure subroutine strains(group, e, local, eps)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      real(wp), intent(out) :: eps(:, :)
      real(wp) :: v(6, most_corners), middle(3), curved(3)
      integer :: k, l, p
      call to_element(group, e, local, v)
      p = 0
      do k = 1, group%rule%points
         middle = membrane(group, e, k, v)
         curved = 0.0_wp
         if (group%section%bends) curved = group%thickness(e) * curvature(group, e, k, v)
         do l = 1, int(group%section%layers)
            p = p + 1
            eps(:, p) = middle + group%height(l) * curved
         end do
      end do
   end subroutine strains

   !> Curvatures from w and the rotations about x and y of the nodes
   pure function curvature(group, e, k, v) result(values)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e, k
      real(wp), intent(in) :: v(6, most_corners)
      real(wp) :: values(3)
      integer :: i
      values = 0.0_wp
      associate (b => group%bend(:, :, k, e))
         do i = 1, group%rule%nodes
            values = values + b(1:3, 3 * i - 2) * v(3, i) + b(1:3, 3 * i - 1) * v(4, i) + b(1:3, 3 * i) * v(5, i)
         end do
      end associate
   end function curvature

   !> Transverse shear strains, likewise
   pure function shearing(group, e, k, v) result(values)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e, k
      real(wp), intent(in) :: v(6, most_corners)
      real(wp) :: values(2)
      integer :: i
      values = 0.0_wp
      associate (b => group%shear(:, :, k, e))
         do i = 1, group%rule%nodes
            values = values + b(1:2, 3 * i - 2) * v(3, i) + b(1:2, 3 * i - 1) * v(4, i) + b(1:2, 3 * i) * v(5, i)
         end do
      end associate
   end function shearing

   !> The transposed product is added to f
   pure subroutine add_product(b, s, f)
      real(wp), intent(in) :: b(:, :)
      real(wp), intent(in) :: s(:)
      real(wp), intent(inout) :: f(6, most_corners)
      integer :: i, j
      do i = 1, size(b, 2) / 3
         do j = 1, 3
            f(2 + j, i) = f(2 + j, i) + dot_product(b(:, 3 * (i - 1) + j), s)
         end do
      end do
   end subroutine add_product

   !> Nodal forces of a unit volume at a point under the stress v in the element's axes
   pure subroutine nodal(group, e, p, v, local)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: v(3)
      real(wp), intent(out) :: local(:)
      real(wp) :: f(6, most_corners)
      integer :: k, l
      call place_of(group, p, k, l)
      f = 0.0_wp
      call add_membrane(group, e, k, v, f)
      if (group%section%bends) call add_product(group%bend(:, :, k, e), &
         group%thickness(e) * group%height(l) * v, f)
      call from_element(group, e, f, local)
   end subroutine nodal

   !> A point's place in the plane and its layer
   pure subroutine place_of(group, p, k, l)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: p
      integer, intent(out) :: k, l
      integer :: within
      within = mod(p - 1, group%per)
      k = 1 + within / int(group%section%layers)
      l = 1 + mod(within, int(group%section%layers))
   end subroutine place_of

   !> Transverse shear moduli of a point in the axes of the element, as a matrix [Pa]
   pure function across(group, p) result(g)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: p
      real(wp) :: g(2, 2), c, s
      c = group%turn(1, p)
      s = group%turn(2, p)
      if (group%cracked(p) == 0) then
         c = 1.0_wp
         s = 0.0_wp
      end if
      associate (n => group%transverse(1, p), t => group%transverse(2, p))
         g(1, 1) = c**2 * n + s**2 * t
         g(2, 2) = s**2 * n + c**2 * t
         g(1, 2) = c * s * (n - t)
         g(2, 1) = g(1, 2)
      end associate
   end function across

   !> Stiffness of a point in the axes of the element [Pa]
   pure function in_element(group, p) result(d)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: p
      real(wp) :: d(3, 3), r(3, 3), c, s
      associate (k => group%stiff(:, p))
         d = reshape([k(1), k(2), 0.0_wp, k(2), k(3), 0.0_wp, 0.0_wp, 0.0_wp, k(4)], [3, 3])
      end associate
      if (group%cracked(p) == 0) return
      c = group%turn(1, p)
      s = group%turn(2, p)
      r(1, :) = [c**2, s**2, c * s]
      r(2, :) = [s**2, c**2, -c * s]
      r(3, :) = [-2.0_wp * c * s, 2.0_wp * c * s, c**2 - s**2]
      d = matmul(d, r)
      d = matmul(transpose(r), d)
   end function in_element

   !> Forces and moments of a section per unit strain and curvature, and its shear forces: sums over the layers
   pure subroutine of_section(group, e, k, a, b, d, g)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e, k                    !! element, point in the plane
      real(wp), intent(out) :: a(3, 3)               !! membrane [N m]
      real(wp), intent(out) :: b(3, 3)               !! both [N m^2]
      real(wp), intent(out) :: d(3, 3)               !! bending [N m^3]
      real(wp), intent(out) :: g(2, 2)               !! shear [N m]
      real(wp) :: stiff(3, 3), z
      integer :: l, p
      a = 0.0_wp
      b = 0.0_wp
      d = 0.0_wp
      g = 0.0_wp
      do l = 1, int(group%section%layers)
         p = (e - 1) * group%per + (k - 1) * int(group%section%layers) + l
         z = group%thickness(e) * group%height(l)
         stiff = group%weight(p) * in_element(group, p)
         a = a + stiff
         b = b + z * stiff
         d = d + z**2 * stiff
         if (group%section%bends) g = g + shear_share * group%weight(p) * across(group, p)
      end do
   end subroutine of_section

   pure subroutine matrix(group, element, k)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: element
      real(wp), intent(out) :: k(:, :)
      real(wp) :: one(most_entries), v(6, most_corners), f(6, most_corners)
      real(wp) :: a(3, 3, most_points), b(3, 3, most_points), d(3, 3, most_points), g(2, 2, most_points)
      integer :: i
      do i = 1, group%rule%points
         call of_section(group, element, i, a(:, :, i), b(:, :, i), d(:, :, i), g(:, :, i))
      end do
      k = 0.0_wp
      do i = 1, group%freedoms
         one = 0.0_wp
         one(i) = 1.0_wp
         call to_element(group, element, one, v)
         f = 0.0_wp
         call add_forces(group, element, a, b, d, g, v, f)
         call from_element(group, element, f, k(:, i))
      end do
   end subroutine matrix

   !> Internal forces of an element in its axes, from the stiffness of its sections
   pure subroutine add_forces(group, e, a, b, d, g, v, f)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: a(3, 3, most_points), b(3, 3, most_points), d(3, 3, most_points), g(2, 2, most_points)
      real(wp), intent(in) :: v(6, most_corners)
      real(wp), intent(inout) :: f(6, most_corners)
      real(wp) :: middle(3), curved(3)
      integer :: k
      do k = 1, group%rule%points
         middle = membrane(group, e, k, v)
         if (.not. group%section%bends) then
            call add_membrane(group, e, k, matmul(a(:, :, k), middle), f)
            cycle
         end if
         curved = curvature(group, e, k, v)
         call add_membrane(group, e, k, matmul(a(:, :, k), middle) + matmul(b(:, :, k), curved), f)
         call add_product(group%bend(:, :, k, e), matmul(b(:, :, k), middle) + matmul(d(:, :, k), curved), f)
      end do
      if (group%section%bends) call add_sheared(group, e, g, v, f)
   end subroutine add_forces

   !> Of these, those of the transverse shear and of the rotations about the normal
   pure subroutine add_sheared(group, e, g, v, f)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: g(2, 2, most_points)
      real(wp), intent(in) :: v(6, most_corners)
      real(wp), intent(inout) :: f(6, most_corners)
      real(wp) :: spin, pull
      integer :: i, k
      do k = 1, group%rule%points
         call add_product(group%shear(:, :, k, e), matmul(g(:, :, k), shearing(group, e, k, v)), f)
      end do
      if (.not. any(group%tie(:, e) > 0.0_wp)) return
      spin = 0.0_wp
      do i = 1, group%rule%nodes
         spin = spin + 0.5_wp * (group%middle(1, i, e) * v(2, i) - group%middle(2, i, e) * v(1, i))
      end do
      do k = 1, group%rule%nodes
         pull = group%tie(k, e) * (v(6, k) - spin)
         f(6, k) = f(6, k) + pull
         do i = 1, group%rule%nodes
            f(2, i) = f(2, i) - 0.5_wp * group%middle(1, i, e) * pull
            f(1, i) = f(1, i) + 0.5_wp * group%middle(2, i, e) * pull
         end do
      end do
   end subroutine add_sheared

   pure subroutine force(group, u, f)
      class(shell_points), intent(in) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: f(0:)
      real(wp) :: local(most_entries), v(6, most_corners), part(6, most_corners)
      real(wp) :: a(3, 3, most_points), b(3, 3, most_points), d(3, 3, most_points), g(2, 2, most_points)
      integer :: e, i
      do e = 1, group%elements
         do i = 1, group%rule%points
            call of_section(group, e, i, a(:, :, i), b(:, :, i), d(:, :, i), g(:, :, i))
         end do
         call group%gather(e, u, local)
         call to_element(group, e, local, v)
         part = 0.0_wp
         call add_forces(group, e, a, b, d, g, v, part)
         call from_element(group, e, part, local)
         do i = 1, group%freedoms
            f(group%equation(i, e)) = f(group%equation(i, e)) + local(i) * group%factor(i, e)
         end do
      end do
   end subroutine force

   !> As of plane points; and the transverse shear moduli (thesis Eq. 4.15)
   pure subroutine refresh(group, p)
      class(shell_points), intent(inout) :: group
      integer, intent(in) :: p
      call refresh_plane(group, p)
      if (group%section%bends) call set_transverse(group, p)
   end subroutine refresh

   !> Transverse shear moduli across both cracks from their teeth
   pure subroutine set_transverse(group, p)
      class(shell_points), intent(inout) :: group
      integer, intent(in) :: p
      real(wp) :: e0, nu, modulus
      integer :: e, k
      e = (p - 1) / group%per + 1
      e0 = group%young(e)
      nu = group%nu(e)
      do k = 1, 2
         modulus = direction_modulus(group, e, p, merge(1, k, group%options%cracking == isotropic))
         if (modulus >= e0 .or. group%axis(e) == axis_joint) then
            group%transverse(k, p) = 0.5_wp * e0 / (1.0_wp + nu)
         else if (group%options%cracking == isotropic) then
            group%transverse(k, p) = 0.5_wp * modulus / (1.0_wp + nu)
         else if (group%options%retention < 0.0_wp) then
            group%transverse(k, p) = 0.5_wp * modulus / (1.0_wp + nu * modulus / e0)
         else
            group%transverse(k, p) = group%options%retention * 0.5_wp * e0 / (1.0_wp + nu)
         end if
      end do
   end subroutine set_transverse

   !> As of plane points; the transverse shear begins without slip
   subroutine begin(group, u, status)
      class(shell_points), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      integer(c_int), intent(out) :: status
      integer :: p
      call begin_plane(group, u, merge(all_rows, 2, group%section%bends), status)
      if (status /= status_ok) return
      do p = 1, merge(group%points, 0, group%section%bends)
         call set_shear(group, p, [0.0_wp, 0.0_wp])
      end do
      group%kept(:, :) = group%history
      call set_elastic(group, status)
   end subroutine begin

   !> As of plane points; slip and transverse shear moduli are those of the last state
   pure subroutine extrapolate(group, ratio)
      class(shell_points), intent(inout) :: group
      real(wp), intent(in) :: ratio
      group%history(:, :) = group%kept
      group%history(1:2, :) = group%kept(1:2, :) + ratio * group%rate(1:2, :)
   end subroutine extrapolate

   !> As of plane points, with transverse shear and the rotations about the normal, which are linear within a step
   pure subroutine respond(group, e, local, how, f, k, energy)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      integer, intent(in) :: how
      real(wp), intent(out) :: f(:)
      real(wp), intent(out) :: k(:, :)
      real(wp), intent(out) :: energy
      real(wp) :: one(most_entries), column(most_entries), g(2, 2, most_points), held(2, most_points), sheared
      integer :: i, n
      logical :: found
      call respond_elastic(group, e, local, how, f, k, energy, found)
      if (found) return
      call respond_plane(group, e, local, how, f, k, energy)
      if (.not. group%section%bends) return
      n = group%freedoms
      call respond_across(group, e, local, column, sheared)
      f(1:n) = f(1:n) + column(1:n)
      energy = energy + sheared
      if (size(k) == 0) return
      call sum_shear(group, e, g, held, sheared)
      held = 0.0_wp
      do i = 1, n
         one = 0.0_wp
         one(i) = 1.0_wp
         call add_across(group, e, one, g, held, column, sheared)
         k(1:n, i) = k(1:n, i) + column(1:n)
      end do
   end subroutine respond

   !> Nodal forces and energy of an element's transverse shear from its slip on, and of the rotations about the normal
   pure subroutine respond_across(group, e, local, column, energy)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      real(wp), intent(out) :: column(most_entries)
      real(wp), intent(out) :: energy                !! [J]
      real(wp) :: g(2, 2, most_points), held(2, most_points), slipped
      call sum_shear(group, e, g, held, slipped)
      call add_across(group, e, local, g, held, column, energy)
      energy = energy + slipped
   end subroutine respond_across

   !> Transverse shear stiffness over the layers, the forces that the slip takes off, and the energy of the slip alone
   pure subroutine sum_shear(group, e, g, held, energy)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(out) :: g(2, 2, most_points)  !! [N m]
      real(wp), intent(out) :: held(2, most_points)  !! [N m]
      real(wp), intent(out) :: energy                !! [J]
      real(wp) :: a(2, 2)
      integer :: k, l, p
      g = 0.0_wp
      held = 0.0_wp
      energy = 0.0_wp
      do k = 1, group%rule%points
         do l = 1, int(group%section%layers)
            p = (e - 1) * group%per + (k - 1) * int(group%section%layers) + l
            a = shear_share * group%weight(p) * shear_of(group, p)
            associate (slip => group%history(slip_x:slip_y, p))
               g(:, :, k) = g(:, :, k) + a
               held(:, k) = held(:, k) + matmul(a, slip)
               energy = energy + 0.5_wp * dot_product(slip, matmul(a, slip))
            end associate
         end do
      end do
   end subroutine sum_shear

   !> Nodal forces and energy of these sums at displacements
   pure subroutine add_across(group, e, local, g, held, column, energy)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      real(wp), intent(in) :: g(2, 2, most_points)   !! [N m]
      real(wp), intent(in) :: held(2, most_points)   !! [N m]
      real(wp), intent(out) :: column(most_entries)
      real(wp), intent(out) :: energy                !! [J]
      real(wp) :: v(6, most_corners), part(6, most_corners)
      integer :: k
      part = 0.0_wp
      call to_element(group, e, local, v)
      call add_sheared(group, e, g, v, part)
      energy = 0.5_wp * sum(part(:, 1:group%rule%nodes) * v(:, 1:group%rule%nodes))
      do k = 1, group%rule%points
         energy = energy - dot_product(held(:, k), shearing(group, e, k, v))
         call add_product(group%shear(:, :, k, e), -held(:, k), part)
      end do
      call from_element(group, e, part, column)
   end subroutine add_across

   !> Transverse shear moduli of a point's history as a matrix [Pa]
   pure function shear_of(group, p) result(a)
      class(shell_points), intent(in) :: group
      integer, intent(in) :: p
      real(wp) :: a(2, 2)
      associate (h => group%history(:, p))
         a = reshape([h(shear_xx), h(shear_xy), h(shear_xy), h(shear_yy)], [2, 2])
      end associate
   end function shear_of

   !> Transverse shear moduli by a point's cracks, and its slip, into its history
   pure subroutine set_shear(group, p, slip)
      class(shell_points), intent(inout) :: group
      integer, intent(in) :: p
      real(wp), intent(in) :: slip(2)
      real(wp) :: a(2, 2)
      a = across(group, p)
      group%history(slip_x:shear_xy, p) = [slip, a(1, 1), a(2, 2), a(1, 2)]
   end subroutine set_shear

   !> As of plane points; the transverse shear follows the cracks: across each, its stress falls with the modulus, and
   !> stays where the modulus grows
   pure subroutine update(group, u, lost)
      class(shell_points), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: lost
      real(wp) :: local(most_entries), v(6, most_corners), column(most_entries), a(2, 2), g(2), n(2), slip(2), before, after
      integer :: e, k, l, p, i
      call update_plane(group, u, lost)
      if (.not. group%section%bends) return
      call show_plane(group, u)
      do e = 1, group%elements
         call group%gather(e, u, local)
         call to_element(group, e, local, v)
         call respond_across(group, e, local, column, before)
         do p = (e - 1) * group%per + 1, e * group%per
            call place_of(group, p, k, l)
            g = shearing(group, e, k, v)
            a = shear_of(group, p)
            slip = group%history(slip_x:slip_y, p)
            call set_transverse(group, p)
            n = [1.0_wp, 0.0_wp]
            if (group%cracked(p) /= 0) n = group%turn(:, p)
            do i = 1, 2
               associate (modulus => group%transverse(i, p), was => dot_product(n, matmul(a, n)))
                  if (modulus > was) slip = slip + (dot_product(n, g - slip) - dot_product(n, matmul(a, g - &
                     group%history(slip_x:slip_y, p))) / modulus) * n
               end associate
               n = [-n(2), n(1)]
            end do
            call set_shear(group, p, slip)
         end do
         call respond_across(group, e, local, column, after)
         lost = lost + max(0.0_wp, before - after)
      end do
   end subroutine update

   !> As of plane points, with the vectors of the transverse shear
   pure subroutine damage(group, point, code, lambda, ua, ub, event, tooth)
      class(shell_points), intent(inout) :: group
      integer, intent(in) :: point
      integer, intent(in) :: code
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      type(event_vectors), intent(out) :: event
      integer, intent(out) :: tooth
      real(wp) :: before(2, 2), change(3, 3), vectors(3, 3), f(6, most_corners), local(most_entries), size
      integer :: e, i, k, l
      before = 0.0_wp
      if (group%section%bends) before = across(group, point)
      call damage_point(group, point, code, lambda, ua, ub, event, tooth)
      if (.not. group%section%bends) return
      e = (point - 1) / group%per + 1
      change = 0.0_wp
      change(1:2, 1:2) = before - across(group, point)
      size = maxval(abs(before))
      call principal(change, vectors)
      call place_of(group, point, k, l)
      do i = 1, 3
         if (.not. abs(change(i, i)) > 1.0e-14_wp * size) cycle
         f = 0.0_wp
         call add_product(group%shear(:, :, k, e), &
            sqrt(shear_share * group%weight(point) * abs(change(i, i))) * vectors(1:2, i), f)
         call from_element(group, e, f, local)
         event%rank = event%rank + 1
         event%sign(event%rank) = sign(1.0_wp, change(i, i))
         call group%spread(e, local, event, event%rank)
      end do
   end subroutine damage

end module shell_group
