!> One step of the Dormand-Prince 5(4) pair for a system of first order, y' = f(t, y).
!>
!> Source: J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26. What has one coordinate of second
!> order is integrated by common_dopri5, which keeps a dense output.
module common_dopri5_system
   use common_kinds, only : wp
   implicit none
   private
   public :: first_order_system, dopri5_system_step

   !> A system of first order
   type, abstract :: first_order_system
   contains
      procedure(slope), deferred :: slope
   end type first_order_system

   abstract interface
      !> y' at the given state
      function slope(system, t, y) result(rate)
         import :: first_order_system, wp
         implicit none (type, external)
         class(first_order_system), intent(in) :: system
         real(wp), intent(in) :: t     !! time [s]
         real(wp), intent(in) :: y(:)  !! state
         real(wp) :: rate(size(y))
      end function slope
   end interface

   real(wp), parameter :: c2 = 1.0_wp / 5.0_wp, c3 = 3.0_wp / 10.0_wp, c4 = 4.0_wp / 5.0_wp, c5 = 8.0_wp / 9.0_wp

contains

   !> One step of length h; the caller accepts it where the misfit is at most 1
   subroutine dopri5_system_step(system, t, h, y, atol, rtol, reached, rates, misfit)
      class(first_order_system), intent(in) :: system
      real(wp), intent(in) :: t            !! start time [s]
      real(wp), intent(in) :: h            !! step length [s]
      real(wp), intent(in) :: y(:)         !! state at t
      real(wp), intent(in) :: atol(:)      !! absolute tolerances
      real(wp), intent(in) :: rtol         !! relative tolerance
      real(wp), intent(out) :: reached(:)  !! state at t + h
      real(wp), intent(out) :: rates(:, :)  !! (numbers, 2): y' at t and at t + h
      real(wp), intent(out) :: misfit      !! estimate of the error over the tolerance, root mean square
      real(wp), dimension(size(y)) :: k1, k2, k3, k4, k5, k6, k7, off
      k1 = system%slope(t, y)
      k2 = system%slope(t + c2 * h, y + h * c2 * k1)
      k3 = system%slope(t + c3 * h, y + h * (3.0_wp / 40.0_wp * k1 + 9.0_wp / 40.0_wp * k2))
      k4 = system%slope(t + c4 * h, y + h * (44.0_wp / 45.0_wp * k1 - 56.0_wp / 15.0_wp * k2 + 32.0_wp / 9.0_wp * k3))
      k5 = system%slope(t + c5 * h, y + h * (19372.0_wp / 6561.0_wp * k1 - 25360.0_wp / 2187.0_wp * k2 &
         + 64448.0_wp / 6561.0_wp * k3 - 212.0_wp / 729.0_wp * k4))
      k6 = system%slope(t + h, y + h * (9017.0_wp / 3168.0_wp * k1 - 355.0_wp / 33.0_wp * k2 &
         + 46732.0_wp / 5247.0_wp * k3 + 49.0_wp / 176.0_wp * k4 - 5103.0_wp / 18656.0_wp * k5))
      reached = y + h * (35.0_wp / 384.0_wp * k1 + 500.0_wp / 1113.0_wp * k3 + 125.0_wp / 192.0_wp * k4 &
         - 2187.0_wp / 6784.0_wp * k5 + 11.0_wp / 84.0_wp * k6)
      k7 = system%slope(t + h, reached)
      off = h * (71.0_wp / 57600.0_wp * k1 - 71.0_wp / 16695.0_wp * k3 + 71.0_wp / 1920.0_wp * k4 &
         - 17253.0_wp / 339200.0_wp * k5 + 22.0_wp / 525.0_wp * k6 - 1.0_wp / 40.0_wp * k7)
      misfit = sqrt(sum((off / (atol + rtol * max(abs(y), abs(reached))))**2) / real(size(y), wp))
      rates(:, 1) = k1
      rates(:, 2) = k7
   end subroutine dopri5_system_step

end module common_dopri5_system
