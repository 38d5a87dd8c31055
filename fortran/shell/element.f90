!> Flat shell elements of four and of three nodes: what their strains are in terms of their freedoms.
!>
!> Bending is that of the discrete Kirchhoff-Mindlin elements DKMQ (Katili 1993) and DKMT (Katili 1993a). The rotations
!> of a side carry a quadratic part d_k beside the linear one; the shear strain along a side is constant and belongs
!> to d_k by the equilibrium of that side, g_k = -2/3 phi_k d_k with phi_k = 2 (t / L_k)^2 / (5/6 (1 - nu)). As phi_k
!> grows the strains become those of MITC4 (Dvorkin and Bathe 1984), as it vanishes those of discrete Kirchhoff
!> elements: thin shells do not lock.
!>
!> The membrane is that of the plane elements Q4 and T3, so that a shell loaded in its plane is the plane model.
!> Rotations about the normal are tied to the rotation of the membrane in the element's middle (Hughes and Brezzi 1989,
!> with one point), at the nodes where the shell has a fold and needs them.
!>
!> An element whose nodes do not lie in a plane is projected onto one; the nodes move its corners by rigid arms.
module shell_element
   use common_kinds, only : wp
   use common_lists, only : element_q4 => sla_element_q4, element_t3 => sla_element_t3, element_t6 => sla_element_t6
   use common_status, only : status_ok, status_bad_geometry
   use sla_element, only : element_rule, element_rule_new, element_gradients, shape_functions, most_nodes, most_points
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: shell_geometry, shell_rule_new, shell_geometry_new, shell_frame, most_corners

   integer, parameter :: most_corners = 4
   !> Share of a uniform shear stress in the stiffness against the parabolic one of a plate
   real(wp), parameter, public :: shear_share = 5.0_wp / 6.0_wp
   !> Least angle between a normal and the vertical of an element that has a horizontal axis of its own, its sine
   real(wp), parameter :: level = 1.0e-3_wp

   !> One element in its own axes: freedoms by node are u, v, w, rotations about x, y, z
   type :: shell_geometry
      real(wp) :: axes(3, 3) = 0.0_wp                            !! rows: x, y, normal
      real(wp) :: arm(most_corners) = 0.0_wp                     !! height of the nodes over the plane [m]
      real(wp) :: corner(2, most_corners) = 0.0_wp               !! [m]
      real(wp) :: gradient(2, most_corners, most_points) = 0.0_wp  !! of the shape functions [1/m]
      real(wp) :: middle(2, most_corners) = 0.0_wp               !! the same in the middle
      real(wp) :: area(most_points) = 0.0_wp                     !! of the points [m^2]
      !> Curvatures x, y, xy [1/m] and shear strains xz, yz per w and rotations about x and y of each node
      real(wp) :: bend(3, 3 * most_corners, most_points) = 0.0_wp
      real(wp) :: shear(2, 3 * most_corners, most_points) = 0.0_wp
   end type shell_geometry

contains

   !> Integration in the plane: two by two points of quadrilaterals, three of triangles
   pure subroutine shell_rule_new(kind, rule, status)
      integer(c_int), intent(in) :: kind            !! Q4 or T3 of the list sla_element
      type(element_rule), intent(out) :: rule
      integer(c_int), intent(out) :: status
      call element_rule_new(merge(element_t6, kind, kind == element_t3), 2_c_int, 2_c_int, rule, status)
      rule%kind = kind
      rule%nodes = int(kind)
   end subroutine shell_rule_new

   !> Axes of an element (rows): the normal is that of its nodes' sense, x is horizontal and y goes up; of a
   !> horizontal one x is the x of the whole
   pure subroutine shell_frame(xyz, axes, status)
      real(wp), intent(in) :: xyz(:, :)             !! (3, nodes) [m]
      real(wp), intent(out) :: axes(3, 3)
      integer(c_int), intent(out) :: status         !! status_bad_geometry: no area
      real(wp) :: a(3), b(3), n(3), double_area
      integer :: nodes
      nodes = size(xyz, 2)
      a = xyz(:, 3) - xyz(:, 1)
      b = xyz(:, 2) - xyz(:, 1)
      if (nodes == 4) then
         b = xyz(:, 4) - xyz(:, 2)
         n = cross(a, b)
      else
         n = cross(b, a)
      end if
      axes = 0.0_wp
      double_area = norm2(n)
      status = status_bad_geometry
      if (.not. double_area > 1.0e-12_wp * max(dot_product(a, a), dot_product(b, b))) return
      status = status_ok
      axes(3, :) = n / double_area
      if (norm2(axes(3, 1:2)) > level) then
         axes(1, :) = cross([0.0_wp, 0.0_wp, 1.0_wp], axes(3, :))
      else
         axes(1, :) = [1.0_wp, 0.0_wp, 0.0_wp] - axes(3, 1) * axes(3, :)
      end if
      axes(1, :) = axes(1, :) / norm2(axes(1, :))
      axes(2, :) = cross(axes(3, :), axes(1, :))
   end subroutine shell_frame

   !> Strains of one element
   pure subroutine shell_geometry_new(rule, xyz, thickness, nu, geometry, status)
      type(element_rule), intent(in) :: rule
      real(wp), intent(in) :: xyz(:, :)             !! (3, nodes) [m]
      real(wp), intent(in) :: thickness             !! [m]
      real(wp), intent(in) :: nu                    !! Poisson's ratio
      type(shell_geometry), intent(out) :: geometry
      integer(c_int), intent(out) :: status         !! status_bad_geometry: inverted or without area
      real(wp) :: gradient(2, most_nodes, most_points), middle(2, most_nodes), centre(3), from(3)
      real(wp) :: extra(3 * most_corners, most_corners), along(2, most_corners)
      real(wp) :: lengths(most_corners), phi(most_corners)
      integer :: i, k, n

      n = rule%nodes
      call shell_frame(xyz, geometry%axes, status)
      if (status /= status_ok) return
      centre = sum(xyz, dim=2) / real(n, wp)
      do i = 1, n
         from = matmul(geometry%axes, xyz(:, i) - centre)
         geometry%corner(:, i) = from(1:2)
         geometry%arm(i) = from(3)
      end do
      call element_gradients(rule, geometry%corner(:, 1:n), gradient(:, 1:n, :), geometry%area, middle(:, 1:n), status)
      if (status /= status_ok) return
      geometry%gradient(:, 1:n, :) = gradient(:, 1:n, :)
      geometry%middle(:, 1:n) = middle(:, 1:n)
      call side_rotations(geometry%corner(:, 1:n), thickness, nu, extra, along, lengths, phi)
      do k = 1, rule%points
         call curvature(rule, k, geometry, extra, along)
         if (n == 4) then
            call shear_of_quadrilateral(rule, k, geometry, extra, phi, lengths)
         else
            call shear_of_triangle(rule, k, geometry, extra, phi, along)
         end if
      end do
   end subroutine shell_geometry_new

   !> The quadratic part of the rotation of each side, in terms of w and the rotations of the nodes
   pure subroutine side_rotations(corner, thickness, nu, extra, along, lengths, phi)
      real(wp), intent(in) :: corner(:, :)          !! (2, nodes) [m]
      real(wp), intent(in) :: thickness             !! [m]
      real(wp), intent(in) :: nu
      real(wp), intent(out) :: extra(:, :)          !! (3 nodes, sides)
      real(wp), intent(out) :: along(:, :)          !! (2, sides) unit vectors
      real(wp), intent(out) :: lengths(:)           !! [m]
      real(wp), intent(out) :: phi(:)               !! compliance in shear over that in bending
      real(wp) :: d(2), share
      integer :: i, j, n
      n = size(corner, 2)
      extra = 0.0_wp
      along = 0.0_wp
      lengths = 1.0_wp
      phi = 0.0_wp
      do i = 1, n
         j = 1 + mod(i, n)
         d = corner(:, j) - corner(:, i)
         lengths(i) = norm2(d)
         along(:, i) = d / lengths(i)
         phi(i) = 2.0_wp * (thickness / lengths(i))**2 / (shear_share * (1.0_wp - nu))
         share = -1.5_wp / (lengths(i) * (1.0_wp + phi(i)))
         extra(3 * i - 2, i) = -share
         extra(3 * j - 2, i) = share
         ! The normal turns by b = (rotation about y, - rotation about x)
         extra([3 * i - 1, 3 * j - 1], i) = -0.5_wp * share * d(2)
         extra([3 * i, 3 * j], i) = 0.5_wp * share * d(1)
      end do
   end subroutine side_rotations

   !> Curvatures at a point
   pure subroutine curvature(rule, k, geometry, extra, along)
      type(element_rule), intent(in) :: rule
      integer, intent(in) :: k                      !! point
      type(shell_geometry), intent(inout) :: geometry
      real(wp), intent(in) :: extra(:, :)
      real(wp), intent(in) :: along(:, :)
      real(wp) :: bubble(2, most_corners)
      integer :: i, n
      n = rule%nodes
      bubble = side_gradients(rule, k, geometry)
      associate (b => geometry%bend(:, :, k))
         b = 0.0_wp
         do i = 1, n
            associate (g => geometry%gradient(:, i, k))
               b(1, 3 * i) = g(1)
               b(2, 3 * i - 1) = -g(2)
               b(3, 3 * i) = g(2)
               b(3, 3 * i - 1) = -g(1)
            end associate
         end do
         do i = 1, n
            associate (p => bubble(:, i), s => along(:, i))
               b(1, 1:3 * n) = b(1, 1:3 * n) + p(1) * s(1) * extra(1:3 * n, i)
               b(2, 1:3 * n) = b(2, 1:3 * n) + p(2) * s(2) * extra(1:3 * n, i)
               b(3, 1:3 * n) = b(3, 1:3 * n) + (p(2) * s(1) + p(1) * s(2)) * extra(1:3 * n, i)
            end associate
         end do
      end associate
   end subroutine curvature

   !> Gradients of the quadratic functions of the sides, 1 in the middle of one and 0 on the others
   pure function side_gradients(rule, k, geometry) result(bubble)
      type(element_rule), intent(in) :: rule
      integer, intent(in) :: k                      !! point
      type(shell_geometry), intent(in) :: geometry
      real(wp) :: bubble(2, most_corners), n(most_nodes), dn(2, most_nodes), natural(2, most_corners), r, s
      real(wp) :: to_plane(2, 2)
      integer :: i, j
      bubble = 0.0_wp
      r = rule%place(1, k)
      s = rule%place(2, k)
      if (rule%nodes == 3) then
         call shape_functions(element_t3, [r, s], n, dn)
         do i = 1, 3
            j = 1 + mod(i, 3)
            bubble(:, i) = 4.0_wp * (n(i) * geometry%gradient(:, j, k) + n(j) * geometry%gradient(:, i, k))
         end do
         return
      end if
      natural(:, 1) = [-r * (1.0_wp - s), -0.5_wp * (1.0_wp - r**2)]
      natural(:, 2) = [0.5_wp * (1.0_wp - s**2), -s * (1.0_wp + r)]
      natural(:, 3) = [-r * (1.0_wp + s), 0.5_wp * (1.0_wp - r**2)]
      natural(:, 4) = [-0.5_wp * (1.0_wp - s**2), -s * (1.0_wp - r)]
      to_plane = inverse(jacobian(rule, k, geometry))
      bubble = matmul(to_plane, natural)
   end function side_gradients

   !> Rows: derivatives of x and y by the natural coordinates
   pure function jacobian(rule, k, geometry) result(j)
      type(element_rule), intent(in) :: rule
      integer, intent(in) :: k
      type(shell_geometry), intent(in) :: geometry
      real(wp) :: j(2, 2), n(most_nodes), dn(2, most_nodes)
      call shape_functions(rule%kind, rule%place(:, k), n, dn)
      j = matmul(dn(:, 1:rule%nodes), transpose(geometry%corner(:, 1:rule%nodes)))
   end function jacobian

   pure function inverse(a) result(b)
      real(wp), intent(in) :: a(2, 2)
      real(wp) :: b(2, 2)
      b = reshape([a(2, 2), -a(2, 1), -a(1, 2), a(1, 1)], [2, 2]) / (a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1))
   end function inverse

   !> Shear strains from those along the sides, linear across to the opposite one
   pure subroutine shear_of_quadrilateral(rule, k, geometry, extra, phi, lengths)
      type(element_rule), intent(in) :: rule
      integer, intent(in) :: k                      !! point
      type(shell_geometry), intent(inout) :: geometry
      real(wp), intent(in) :: extra(:, :)
      real(wp), intent(in) :: phi(:)
      real(wp), intent(in) :: lengths(:)
      real(wp) :: natural(2, 12), half(4), to_plane(2, 2), r, s
      r = rule%place(1, k)
      s = rule%place(2, k)
      half = -phi * lengths / 3.0_wp                ! natural strain along a side per its rotation
      natural(1, :) = 0.5_wp * ((1.0_wp - s) * half(1) * extra(:, 1) - (1.0_wp + s) * half(3) * extra(:, 3))
      natural(2, :) = 0.5_wp * ((1.0_wp + r) * half(2) * extra(:, 2) - (1.0_wp - r) * half(4) * extra(:, 4))
      to_plane = inverse(jacobian(rule, k, geometry))
      geometry%shear(:, :, k) = matmul(to_plane, natural)
   end subroutine shear_of_quadrilateral

   !> Shear strains from those along the sides, which meet at each corner; linear in between
   pure subroutine shear_of_triangle(rule, k, geometry, extra, phi, along)
      type(element_rule), intent(in) :: rule
      integer, intent(in) :: k                      !! point
      type(shell_geometry), intent(inout) :: geometry
      real(wp), intent(in) :: extra(:, :)
      real(wp), intent(in) :: phi(:)
      real(wp), intent(in) :: along(:, :)
      real(wp) :: n(most_nodes), dn(2, most_nodes), sides(2, 12), to_plane(2, 2)
      integer :: i, before
      call shape_functions(element_t3, rule%place(:, k), n, dn)
      geometry%shear(:, :, k) = 0.0_wp
      do i = 1, 3
         before = 1 + mod(i + 1, 3)
         sides(1, :) = -2.0_wp / 3.0_wp * phi(i) * extra(:, i)
         sides(2, :) = -2.0_wp / 3.0_wp * phi(before) * extra(:, before)
         to_plane = inverse(transpose(reshape([along(:, i), along(:, before)], [2, 2])))
         geometry%shear(:, :, k) = geometry%shear(:, :, k) + n(i) * matmul(to_plane, sides)
      end do
   end subroutine shear_of_triangle

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
   end function cross

end module shell_element
