!> One step of an integrator with its continuous extension: two polynomials in the fraction of the step.
module common_dense_step
   use common_kinds, only : wp
   implicit none
   private
   public :: dense_step, dense_degree

   !> Highest degree of an extension
   integer, parameter :: dense_degree = 9

   type :: dense_step
      real(wp) :: t      !! start time
      real(wp) :: h      !! length
      real(wp) :: q      !! coordinate at the end
      real(wp) :: v      !! rate at the end
      real(wp) :: a      !! acceleration at the end, where the integrator reuses it
      real(wp) :: error  !! estimate over tolerance; accept where <= 1
      integer :: degree  !! of both polynomials
      real(wp) :: cq(0:dense_degree)  !! coefficients of q
      real(wp) :: cv(0:dense_degree)  !! coefficients of v
   contains
      procedure :: coordinate
      procedure :: rate
      procedure :: cut
   end type dense_step

contains

   !> q at the fraction s in [0, 1] of the step
   pure function coordinate(dense, s) result(q)
      class(dense_step), intent(in) :: dense
      real(wp), intent(in) :: s
      real(wp) :: q
      integer :: k
      q = dense%cq(dense%degree)
      do k = dense%degree - 1, 0, -1
         q = dense%cq(k) + s * q
      end do
   end function coordinate

   !> q' at the fraction s in [0, 1] of the step
   pure function rate(dense, s) result(v)
      class(dense_step), intent(in) :: dense
      real(wp), intent(in) :: s
      real(wp) :: v
      integer :: k
      v = dense%cv(dense%degree)
      do k = dense%degree - 1, 0, -1
         v = dense%cv(k) + s * v
      end do
   end function rate

   !> Keep the first part of the step only
   pure subroutine cut(dense, fraction)
      class(dense_step), intent(inout) :: dense
      real(wp), intent(in) :: fraction
      real(wp) :: power
      integer :: k
      dense%q = dense%coordinate(fraction)
      dense%v = dense%rate(fraction)
      dense%h = fraction * dense%h
      power = 1.0_wp
      do k = 1, dense%degree
         power = power * fraction
         dense%cq(k) = dense%cq(k) * power
         dense%cv(k) = dense%cv(k) * power
      end do
   end subroutine cut

end module common_dense_step
