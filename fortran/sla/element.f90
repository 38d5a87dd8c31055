!> Plane elements: shape functions, integration rules, gradients.
module sla_element
   use common_kinds, only : wp
   use common_lists, only : element_t3 => sla_element_t3, element_t6 => sla_element_t6, element_q4 => sla_element_q4, &
      element_q8 => sla_element_q8
   use common_status, only : status_ok, status_invalid_argument, status_bad_geometry
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: element_rule, element_rule_new, shape_functions, element_gradients
   public :: most_nodes, most_points

   integer, parameter :: most_nodes = 8, most_points = 16

   !> Element kind with its integration points
   type :: element_rule
      integer(c_int) :: kind = element_q4
      integer :: nodes = 4
      integer :: points = 4
      real(wp) :: place(2, most_points) = 0.0_wp   !! natural coordinates
      real(wp) :: weight(most_points) = 0.0_wp
   end type element_rule

contains

   !> Rule of an element; nx, ny Gauss points per direction of a quadrilateral (1 to 4)
   pure subroutine element_rule_new(kind, nx, ny, rule, status)
      integer(c_int), intent(in) :: kind
      integer(c_int), intent(in) :: nx
      integer(c_int), intent(in) :: ny
      type(element_rule), intent(out) :: rule
      integer(c_int), intent(out) :: status
      real(wp) :: x(4), wx(4), y(4), wy(4)
      integer :: i, j, k

      status = status_ok
      rule%kind = kind
      rule%nodes = int(kind)
      select case (kind)
      case (element_t3)
         rule%points = 1
         rule%place(:, 1) = 1.0_wp / 3.0_wp
         rule%weight(1) = 0.5_wp
      case (element_t6)
         rule%points = 3
         rule%place(:, 1) = [1.0_wp / 6.0_wp, 1.0_wp / 6.0_wp]
         rule%place(:, 2) = [2.0_wp / 3.0_wp, 1.0_wp / 6.0_wp]
         rule%place(:, 3) = [1.0_wp / 6.0_wp, 2.0_wp / 3.0_wp]
         rule%weight(1:3) = 1.0_wp / 6.0_wp
      case (element_q4, element_q8)
         if (min(nx, ny) < 1 .or. max(nx, ny) > 4) then
            status = status_invalid_argument
            return
         end if
         call gauss(int(nx), x, wx)
         call gauss(int(ny), y, wy)
         rule%points = int(nx * ny)
         k = 0
         do j = 1, int(ny)
            do i = 1, int(nx)
               k = k + 1
               rule%place(:, k) = [x(i), y(j)]
               rule%weight(k) = wx(i) * wy(j)
            end do
         end do
      case default
         status = status_invalid_argument
      end select
   end subroutine element_rule_new

   !> Gauss-Legendre points and weights on (-1, 1)
   pure subroutine gauss(n, x, w)
      integer, intent(in) :: n
      real(wp), intent(out) :: x(4)
      real(wp), intent(out) :: w(4)
      real(wp) :: a, b
      x = 0.0_wp
      w = 0.0_wp
      select case (n)
      case (1)
         w(1) = 2.0_wp
      case (2)
         a = sqrt(1.0_wp / 3.0_wp)
         x(1:2) = [-a, a]
         w(1:2) = 1.0_wp
      case (3)
         a = sqrt(0.6_wp)
         x(1:3) = [-a, 0.0_wp, a]
         w(1:3) = [5.0_wp, 8.0_wp, 5.0_wp] / 9.0_wp
      case default
         a = sqrt((3.0_wp - 2.0_wp * sqrt(1.2_wp)) / 7.0_wp)
         b = sqrt((3.0_wp + 2.0_wp * sqrt(1.2_wp)) / 7.0_wp)
         x = [-b, -a, a, b]
         w(2:3) = (18.0_wp + sqrt(30.0_wp)) / 36.0_wp
         w([1, 4]) = (18.0_wp - sqrt(30.0_wp)) / 36.0_wp
      end select
   end subroutine gauss

   !> Shape functions and their natural derivatives; corners first, then the middles of the sides
   pure subroutine shape_functions(kind, at, n, dn)
      integer(c_int), intent(in) :: kind
      real(wp), intent(in) :: at(2)                 !! natural coordinates
      real(wp), intent(out) :: n(most_nodes)
      real(wp), intent(out) :: dn(2, most_nodes)
      real(wp), parameter :: sx(8) = [-1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, -1.0_wp]
      real(wp), parameter :: sy(8) = [-1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp]
      real(wp) :: r, s, t, l(3), dl(2, 3)
      integer :: i, j

      n = 0.0_wp
      dn = 0.0_wp
      r = at(1)
      s = at(2)
      select case (kind)
      case (element_t3, element_t6)
         l = [1.0_wp - r - s, r, s]
         dl = reshape([-1.0_wp, -1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 3])
         if (kind == element_t3) then
            n(1:3) = l
            dn(:, 1:3) = dl
         else
            do i = 1, 3
               j = mod(i, 3) + 1
               n(i) = l(i) * (2.0_wp * l(i) - 1.0_wp)
               dn(:, i) = (4.0_wp * l(i) - 1.0_wp) * dl(:, i)
               n(i + 3) = 4.0_wp * l(i) * l(j)
               dn(:, i + 3) = 4.0_wp * (l(i) * dl(:, j) + l(j) * dl(:, i))
            end do
         end if
      case (element_q4)
         do i = 1, 4
            n(i) = 0.25_wp * (1.0_wp + sx(i) * r) * (1.0_wp + sy(i) * s)
            dn(:, i) = 0.25_wp * [sx(i) * (1.0_wp + sy(i) * s), sy(i) * (1.0_wp + sx(i) * r)]
         end do
      case default
         do i = 1, 4
            t = sx(i) * r + sy(i) * s - 1.0_wp
            n(i) = 0.25_wp * (1.0_wp + sx(i) * r) * (1.0_wp + sy(i) * s) * t
            dn(1, i) = 0.25_wp * sx(i) * (1.0_wp + sy(i) * s) * (t + 1.0_wp + sx(i) * r)
            dn(2, i) = 0.25_wp * sy(i) * (1.0_wp + sx(i) * r) * (t + 1.0_wp + sy(i) * s)
         end do
         do i = 5, 7, 2
            n(i) = 0.5_wp * (1.0_wp - r**2) * (1.0_wp + sy(i) * s)
            dn(:, i) = [-r * (1.0_wp + sy(i) * s), 0.5_wp * sy(i) * (1.0_wp - r**2)]
         end do
         do i = 6, 8, 2
            n(i) = 0.5_wp * (1.0_wp - s**2) * (1.0_wp + sx(i) * r)
            dn(:, i) = [0.5_wp * sx(i) * (1.0_wp - s**2), -s * (1.0_wp + sx(i) * r)]
         end do
      end select
   end subroutine shape_functions

   !> Gradients of the shape functions at the points of one element
   pure subroutine element_gradients(rule, xy, gradient, area, middle, status)
      type(element_rule), intent(in) :: rule
      real(wp), intent(in) :: xy(:, :)           !! (2, nodes) [m]
      real(wp), intent(out) :: gradient(:, :, :) !! (2, nodes, points) [1/m]
      real(wp), intent(out) :: area(:)           !! of each point [m^2]
      real(wp), intent(out) :: middle(:, :)      !! (2, nodes) gradients at the element's middle
      integer(c_int), intent(out) :: status      !! status_bad_geometry: inverted or without area
      real(wp) :: centre(2), det
      integer :: k

      gradient = 0.0_wp
      area = 0.0_wp
      centre = merge(1.0_wp / 3.0_wp, 0.0_wp, rule%kind == element_t3 .or. rule%kind == element_t6)
      call gradients_at(centre, middle, det, status)
      do k = 1, rule%points
         if (status /= status_ok) return
         call gradients_at(rule%place(:, k), gradient(:, :, k), det, status)
         area(k) = det * rule%weight(k)
      end do

   contains

      pure subroutine gradients_at(at, values, determinant, code)
         real(wp), intent(in) :: at(2)
         real(wp), intent(out) :: values(:, :)
         real(wp), intent(out) :: determinant
         integer(c_int), intent(out) :: code
         real(wp) :: n(most_nodes), dn(2, most_nodes), jacobian(2, 2), inverse(2, 2)
         call shape_functions(rule%kind, at, n, dn)
         jacobian = matmul(dn(:, 1:rule%nodes), transpose(xy))
         determinant = jacobian(1, 1) * jacobian(2, 2) - jacobian(1, 2) * jacobian(2, 1)
         values = 0.0_wp
         code = status_bad_geometry
         if (.not. determinant > 1.0e-12_wp * maxval(abs(jacobian))**2) return
         inverse = reshape([jacobian(2, 2), -jacobian(2, 1), -jacobian(1, 2), jacobian(1, 1)], [2, 2]) / determinant
         values = matmul(inverse, dn(:, 1:rule%nodes))
         code = status_ok
      end subroutine gradients_at

   end subroutine element_gradients

end module sla_element
