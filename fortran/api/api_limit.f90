!> Small linear programmes of limit analysis, and the systems of equations of large ones.
module api_limit
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: vertex, factor_band, solve_band, lay_springs, factor_springs, solve_springs

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

   !> Stiffness of blocks on springs at their points of contact, as a band
   subroutine lay_springs(most, d, points, high, n, arms, row, springs, band)
      use limit_springs, only : lay => lay_springs
      integer(c_int), intent(in) :: most                       !! equations of a point
      integer(c_int), intent(in) :: d                          !! components of a force
      integer(c_int), intent(in) :: points                     !! of contact
      integer(c_int), intent(in) :: high                       !! 3 width + 1
      integer(c_int), intent(in) :: n                          !! equations
      real(c_double), intent(in) :: arms(most, d, points)      !! forces on the equations of each point
      integer(c_int), intent(in) :: row(most, points)          !! its equations, 0 beyond their number
      real(c_double), intent(in) :: springs(d, d, points)      !! forces by motions, the second index for the force
      real(c_double), intent(inout) :: band(high, n)           !! replaced
      !f2py threadsafe
      call lay(arms, row, springs, band)
   end subroutine lay_springs

   !> Factors of a band without symmetry, in its place
   subroutine factor_springs(high, n, band, pivot, status)
      use limit_springs, only : factor => factor_springs
      integer(c_int), intent(in) :: high              !! 3 width + 1
      integer(c_int), intent(in) :: n                 !! equations
      real(c_double), intent(inout) :: band(high, n)  !! of lay_springs
      integer(c_int), intent(out) :: pivot(n)         !! of the rows
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call factor(band, pivot, status)
   end subroutine factor_springs

   !> The x of K x = b by the factors of factor_springs
   subroutine solve_springs(high, n, sides, band, pivot, x, status)
      use limit_springs, only : solve => solve_springs
      integer(c_int), intent(in) :: high              !! 3 width + 1
      integer(c_int), intent(in) :: n                 !! equations
      integer(c_int), intent(in) :: sides             !! right-hand sides
      real(c_double), intent(in) :: band(high, n)     !! what factor_springs left there
      integer(c_int), intent(in) :: pivot(n)          !! of factor_springs
      real(c_double), intent(inout) :: x(n, sides)    !! b, then x
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call solve(band, pivot, x, status)
   end subroutine solve_springs

end module api_limit
