!> Plane-stress elements: how their points are strained. The law of the points is that of sla_plane_points, what a tooth
!> does to them that of sla_plane_damage.
module sla_plane
   use common_kinds, only : wp
   use common_lists, only : element_q4 => sla_element_q4
   use common_status, only : status_ok, status_out_of_memory, status_invalid_argument
   use sla_element, only : element_rule_new, element_gradients, most_nodes, most_points
   use sla_group, only : material_options
   use sla_plane_damage, only : plane_damage
   use sla_plane_points, only : points_new, points_ready, in_crack_axes, in_element_axes, stress_at, is_triangle
   use sla_tables, only : tooth_tables
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: plane_group, plane_group_new

   type, extends(plane_damage) :: plane_group
      real(wp), allocatable :: gradient(:, :, :)         !! (2, nodes, points) [1/m]
      real(wp), allocatable :: shear_gradient(:, :, :)   !! (2, nodes, elements), if selective
   contains
      procedure :: strains
      procedure :: nodal
      procedure :: matrix
      procedure :: force
   end type plane_group

contains

   !> A group of one element kind; the damage is set to none
   subroutine plane_group_new(kind, nx, ny, selective, xy, connect, property, choice, teeth, options, group, bad, &
                              status)
      integer(c_int), intent(in) :: kind            !! of the list sla_element
      integer(c_int), intent(in) :: nx              !! Gauss points of quadrilaterals
      integer(c_int), intent(in) :: ny
      logical, intent(in) :: selective
      real(wp), intent(in) :: xy(:, :)              !! (2, nodes) [m]
      integer(c_int), intent(in) :: connect(:, :)   !! (nodes of an element, elements), 1-based
      real(wp), intent(in) :: property(:, :)        !! (14, elements), see points_new
      integer(c_int), intent(in) :: choice(:, :)    !! (5, elements), see points_new
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
      group%per = per
      group%freedoms = 2 * group%rule%nodes
      group%selective = selective
      call points_new(group, property, choice, teeth, options, status)
      if (status /= status_ok) return
      allocate (group%gradient(2, group%rule%nodes, group%points), &
         group%shear_gradient(2, group%rule%nodes, merge(ne, 0, selective)), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      do e = 1, ne
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
         group%side(:, e) = 0.0_wp
         if (.not. is_triangle(group)) then
            group%side(:, e) = group%diagonal(:, 2, e)
            group%diagonal(:, 2, e) = xy(:, connect(4, e)) - xy(:, connect(2, e))
         end if
         group%weight(p + 1:p + per) = area(1:per) * property(1, e)
      end do
      call points_ready(group)
   end subroutine plane_group_new

   !> See plane_points
   pure subroutine strains(group, e, local, eps)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      real(wp), intent(out) :: eps(:, :)
      real(wp) :: x, y, g
      integer :: i, j, p

      do j = 1, group%per
         p = (e - 1) * group%per + j
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
         eps(:, j) = [x, y, g]
      end do
   end subroutine strains

   !> See plane_points
   pure subroutine nodal(group, e, p, v, local)
      class(plane_group), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: v(3)
      real(wp), intent(out) :: local(:)
      integer :: i

      do i = 1, group%rule%nodes
         if (group%selective) then
            local(2 * i - 1) = group%gradient(1, i, p) * v(1) + group%shear_gradient(2, i, e) * v(3)
            local(2 * i) = group%gradient(2, i, p) * v(2) + group%shear_gradient(1, i, e) * v(3)
         else
            local(2 * i - 1) = group%gradient(1, i, p) * v(1) + group%gradient(2, i, p) * v(3)
            local(2 * i) = group%gradient(2, i, p) * v(2) + group%gradient(1, i, p) * v(3)
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
      do p = (element - 1) * group%per + 1, element * group%per
         call group%nodal(element, p, in_element_axes(group, p, [1.0_wp, 0.0_wp, 0.0_wp]), b(1:n, 1))
         call group%nodal(element, p, in_element_axes(group, p, [0.0_wp, 1.0_wp, 0.0_wp]), b(1:n, 2))
         call group%nodal(element, p, in_element_axes(group, p, [0.0_wp, 0.0_wp, 1.0_wp]), b(1:n, 3))
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
      real(wp) :: local(2 * most_nodes), part(2 * most_nodes), eps(3, most_points)
      integer :: e, p, i

      do e = 1, group%elements
         call group%gather(e, u, local)
         call group%strains(e, local, eps)
         do p = (e - 1) * group%per + 1, e * group%per
            call group%nodal(e, p, in_element_axes(group, p, group%weight(p) * stress_at(group, p, &
               in_crack_axes(group, p, eps(:, p - (e - 1) * group%per)))), part)
            do i = 1, group%freedoms
               f(group%equation(i, e)) = f(group%equation(i, e)) + part(i) * group%factor(i, e)
            end do
         end do
      end do
   end subroutine force

end module sla_plane
