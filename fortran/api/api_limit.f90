!> Small linear programmes of limit analysis, and the systems of equations of large ones.
module api_limit
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: vertex, factor_band, solve_band

contains

   !> The x of least cost with gradients^T x >= least and low <= x <= high
   subroutine vertex(n, k, gradients, least, cost, low, high, x, rows, sides, solved, status)
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
      integer(c_int), intent(out) :: status
      logical :: found
      !f2py threadsafe
      call least_vertex(gradients, least, cost, low, high, x, rows, sides, found, status)
      solved = merge(1, 0, found)
   end subroutine vertex

   !> Cholesky's factor of a symmetric positive band, in its place
   subroutine factor_band(high, n, band, status)
      use limit_c_bindings, only : extrados_band_factor
      integer(c_int), intent(in) :: high              !! entries of a column, from the diagonal down
      integer(c_int), intent(in) :: n                 !! equations
      real(c_double), intent(inout) :: band(high, n)  !! lower triangle by columns
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      status = extrados_band_factor(int(n, c_int64_t), int(high - 1, c_int64_t), band)
   end subroutine factor_band

   !> The x of K x = b by the factor of the band K
   subroutine solve_band(high, n, band, x)
      use limit_c_bindings, only : extrados_band_solve
      integer(c_int), intent(in) :: high              !! entries of a column, from the diagonal down
      integer(c_int), intent(in) :: n                 !! equations
      real(c_double), intent(in) :: band(high, n)     !! what factor_band left there
      real(c_double), intent(inout) :: x(n)           !! b, then x
      !f2py threadsafe
      call extrados_band_solve(int(n, c_int64_t), int(high - 1, c_int64_t), band, x)
   end subroutine solve_band

end module api_limit
