!> Consistent nodal forces of body forces.
module sla_loads
   use common_kinds, only : wp
   use common_status, only : status_ok
   use sla_element, only : element_rule, element_rule_new, shape_functions, element_gradients, &
      most_nodes, most_points
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: distribute_force

contains

   !> Nodal forces of a uniform force per area in each element
   pure subroutine distribute_force(kind, nx, ny, xy, connect, density, force, bad, status)
      integer(c_int), intent(in) :: kind
      integer(c_int), intent(in) :: nx
      integer(c_int), intent(in) :: ny
      real(wp), intent(in) :: xy(:, :)              !! (2, nodes) [m]
      integer(c_int), intent(in) :: connect(:, :)   !! (nodes of an element, elements), 1-based
      real(wp), intent(in) :: density(:, :)         !! (2, elements) [N/m^2]
      real(wp), intent(out) :: force(:, :)          !! (2, nodes) [N]
      integer(c_int), intent(out) :: bad            !! inverted element, 1-based
      integer(c_int), intent(out) :: status
      type(element_rule) :: rule
      real(wp) :: gradient(2, most_nodes, most_points), area(most_points), middle(2, most_nodes), corner(2, most_nodes)
      real(wp) :: n(most_nodes), dn(2, most_nodes)
      integer :: e, i, k

      force = 0.0_wp
      bad = 0
      ! The shape functions of quadratic elements need two points each way, whatever the stiffness uses.
      call element_rule_new(kind, max(nx, 2_c_int), max(ny, 2_c_int), rule, status)
      if (status /= status_ok) return
      do e = 1, size(connect, 2)
         do i = 1, size(connect, 1)   ! a list of columns as an argument would be a copy that nobody checks
            corner(:, i) = xy(:, connect(i, e))
         end do
         call element_gradients(rule, corner(:, 1:size(connect, 1)), gradient(:, 1:rule%nodes, :), area, &
            middle(:, 1:rule%nodes), status)
         if (status /= status_ok) then
            bad = int(e, c_int)
            return
         end if
         do k = 1, rule%points
            call shape_functions(kind, rule%place(:, k), n, dn)
            do i = 1, rule%nodes
               force(:, connect(i, e)) = force(:, connect(i, e)) + area(k) * n(i) * density(:, e)
            end do
         end do
      end do
   end subroutine distribute_force

end module sla_loads
