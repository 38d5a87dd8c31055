!> One step of the Dormand-Prince 5(4) pair for a system of first order, y' = f(t, y), of few numbers.
!>
!> Source: J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26. What has one coordinate of second
!> order is integrated by common_dopri5, which keeps a dense output.
module common_dopri5_system
   use common_kinds, only : wp
   implicit none
   private
   public :: first_order_system, dopri5_system_step, most_numbers

   !> A state has at most so many numbers: room that needs no allocation
   integer, parameter :: most_numbers = 8

   !> A system of first order
   type, abstract :: first_order_system
   contains
      procedure(find_rates), deferred :: find_rates
   end type first_order_system

   abstract interface
      !> y' at the given state
      subroutine find_rates(system, t, y, rate)
         import :: first_order_system, wp
         implicit none (type, external)
         class(first_order_system), intent(in) :: system
         real(wp), intent(in) :: t         !! time [s]
         real(wp), intent(in) :: y(:)      !! state
         real(wp), intent(out) :: rate(:)  !! y'
      end subroutine find_rates
   end interface

   real(wp), parameter :: c(2:6) = [1.0_wp / 5.0_wp, 3.0_wp / 10.0_wp, 4.0_wp / 5.0_wp, 8.0_wp / 9.0_wp, 1.0_wp]
   !> Weights of the rates before each stage; those of the last one make the step
   real(wp), parameter :: a2(1) = [1.0_wp / 5.0_wp]
   real(wp), parameter :: a3(2) = [3.0_wp / 40.0_wp, 9.0_wp / 40.0_wp]
   real(wp), parameter :: a4(3) = [44.0_wp / 45.0_wp, -56.0_wp / 15.0_wp, 32.0_wp / 9.0_wp]
   real(wp), parameter :: a5(4) = [19372.0_wp / 6561.0_wp, -25360.0_wp / 2187.0_wp, 64448.0_wp / 6561.0_wp, &
      -212.0_wp / 729.0_wp]
   real(wp), parameter :: a6(5) = [9017.0_wp / 3168.0_wp, -355.0_wp / 33.0_wp, 46732.0_wp / 5247.0_wp, &
      49.0_wp / 176.0_wp, -5103.0_wp / 18656.0_wp]
   real(wp), parameter :: a7(6) = [35.0_wp / 384.0_wp, 0.0_wp, 500.0_wp / 1113.0_wp, 125.0_wp / 192.0_wp, &
      -2187.0_wp / 6784.0_wp, 11.0_wp / 84.0_wp]
   real(wp), parameter :: off(7) = [71.0_wp / 57600.0_wp, 0.0_wp, -71.0_wp / 16695.0_wp, 71.0_wp / 1920.0_wp, &
      -17253.0_wp / 339200.0_wp, 22.0_wp / 525.0_wp, -1.0_wp / 40.0_wp]

contains

   !> One step of length h; the caller accepts it where the misfit is at most 1
   subroutine dopri5_system_step(system, t, h, y, rate, atol, rtol, reached, rate_there, misfit)
      class(first_order_system), intent(in) :: system
      real(wp), intent(in) :: t              !! start time [s]
      real(wp), intent(in) :: h              !! step length [s]
      real(wp), intent(in) :: y(:)           !! state at t, at most most_numbers
      real(wp), intent(in) :: rate(:)        !! y' at t
      real(wp), intent(in) :: atol(:)        !! absolute tolerances
      real(wp), intent(in) :: rtol           !! relative tolerance
      real(wp), intent(out) :: reached(:)    !! state at t + h
      real(wp), intent(out) :: rate_there(:) !! y' at t + h
      real(wp), intent(out) :: misfit        !! estimate of the error over the tolerance, root mean square
      real(wp) :: k(most_numbers, 7), z(most_numbers)
      integer :: i, n

      n = size(y)
      k(:n, 1) = rate
      call stage(2, a2)
      call stage(3, a3)
      call stage(4, a4)
      call stage(5, a5)
      call stage(6, a6)
      do i = 1, n
         reached(i) = y(i) + h * dot_product(a7, k(i, :6))
      end do
      call system%find_rates(t + h, reached, k(:n, 7))
      misfit = 0.0_wp
      do i = 1, n
         misfit = misfit + (h * dot_product(off, k(i, :)) / (atol(i) + rtol * max(abs(y(i)), abs(reached(i)))))**2
      end do
      misfit = sqrt(misfit / real(n, wp))
      rate_there = k(:n, 7)

   contains

      !> The rates at stage s
      subroutine stage(s, a)
         integer, intent(in) :: s
         real(wp), intent(in) :: a(:)
         integer :: m
         do m = 1, n
            z(m) = y(m) + h * dot_product(a, k(m, :s - 1))
         end do
         call system%find_rates(t + c(s) * h, z(:n), k(:n, s))
      end subroutine stage

   end subroutine dopri5_system_step

end module common_dopri5_system
