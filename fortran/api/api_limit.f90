!> Small linear programmes of limit analysis.
module api_limit
   use, intrinsic :: iso_c_binding, only : c_double, c_int
   implicit none
   private
   public :: vertex

contains

   !> The x of least cost with gradients^T x >= least and low <= x <= high
   subroutine vertex(n, k, gradients, least, cost, low, high, x, rows, sides, solved)
      use limit_vertex, only : least_vertex
      integer(c_int), intent(in) :: n                 !! unknowns
      integer(c_int), intent(in) :: k                 !! rows
      real(c_double), intent(in) :: gradients(n, k)   !! of the rows, one a column
      real(c_double), intent(in) :: least(k)          !! values of the rows
      real(c_double), intent(in) :: cost(n)           !! by unit of each unknown
      real(c_double), intent(in) :: low(n)            !! finite
      real(c_double), intent(in) :: high(n)           !! finite
      real(c_double), intent(out) :: x(n)             !! of least cost; worth nothing where not solved
      real(c_double), intent(out) :: rows(k)          !! multipliers of the rows
      real(c_double), intent(out) :: sides(n)         !! multipliers of the box, negative at its upper side
      integer(c_int), intent(out) :: solved           !! 1, or 0 where another method must decide
      logical :: found
      !f2py threadsafe
      call least_vertex(gradients, least, cost, low, high, x, rows, sides, found)
      solved = merge(1, 0, found)
   end subroutine vertex

end module api_limit
