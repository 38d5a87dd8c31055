!> Any mechanism as a rocking structure: tables of its coefficients, one for each side.
module rocking_table_rocker
   use common_kinds, only : wp
   use common_status, only : status_ok, status_invalid_argument
   use mechanism_table, only : side_table, table_numbers, table_unpack
   use rocking_rocker, only : rocker, side_index
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: table_rocker, table_rocker_new, table_parameters

   !> Length of the parameter list: restitution of the impacts that start rocking to +x and to -x, the tables of both
   integer, parameter :: table_parameters = 2 + 2 * table_numbers
   !> Rounding allowed to an impact that keeps all energy
   real(wp), parameter :: slack = 1.0e-9_wp

   type, extends(rocker) :: table_rocker
      type(side_table) :: table(2)
   contains
      procedure :: coefficients
      procedure :: potential
   end type table_rocker

contains

   !> Set up from the flat parameter list of the facades
   subroutine table_rocker_new(parameters, body, status)
      real(wp), intent(in) :: parameters(:)    !! see table_parameters
      type(table_rocker), intent(out) :: body
      integer(c_int), intent(out) :: status    !! status_invalid_argument also where an impact would create energy
      real(wp) :: m(2), half_dm, dv, dh
      logical :: closed
      integer :: i, first

      status = status_invalid_argument
      if (size(parameters) < table_parameters) return
      body%restitution = parameters(1:2)
      do i = 1, 2
         first = 3 + (i - 1) * table_numbers
         call table_unpack(parameters(first:first + table_numbers - 1), body%table(i), status)
         if (status /= status_ok) return
         body%critical(i) = body%table(i)%critical
         body%limit(i) = body%table(i)%limit
         call body%table(i)%coefficients(0.0_wp, m(i), half_dm, dv, dh, closed)
      end do
      ! The coordinates of the two sides may count differently: it is the energy that must not grow.
      if (any(body%restitution < 0.0_wp) .or. any(body%restitution**2 * m > (1.0_wp + slack) * m([2, 1]))) then
         status = status_invalid_argument
         return
      end if
      call body%set_rest_rate()
   end subroutine table_rocker_new

   pure subroutine coefficients(model, side, q, m, half_dm, dv, dh, closed)
      class(table_rocker), intent(in) :: model
      integer, intent(in) :: side
      real(wp), intent(in) :: q
      real(wp), intent(out) :: m
      real(wp), intent(out) :: half_dm
      real(wp), intent(out) :: dv
      real(wp), intent(out) :: dh
      logical, intent(out) :: closed
      call model%table(side_index(side))%coefficients(q, m, half_dm, dv, dh, closed)
   end subroutine coefficients

   pure function potential(model, side, q) result(v)
      class(table_rocker), intent(in) :: model
      integer, intent(in) :: side
      real(wp), intent(in) :: q
      real(wp) :: v
      v = model%table(side_index(side))%potential(q)
   end function potential

end module rocking_table_rocker
