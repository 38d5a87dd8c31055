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
   pure function coordinate(self, s) result(q)
      class(dense_step), intent(in) :: self
      real(wp), intent(in) :: s
      real(wp) :: q
      integer :: k
      q = self%cq(self%degree)
      do k = self%degree - 1, 0, -1
         q = self%cq(k) + s * q
      end do
   end function coordinate

   !> q' at the fraction s in [0, 1] of the step
   pure function rate(self, s) result(v)
      class(dense_step), intent(in) :: self
      real(wp), intent(in) :: s
      real(wp) :: v
      integer :: k
      v = self%cv(self%degree)
      do k = self%degree - 1, 0, -1
         v = self%cv(k) + s * v
      end do
   end function rate

   !> Keep the first part of the step only
   pure subroutine cut(self, fraction)
      class(dense_step), intent(inout) :: self
      real(wp), intent(in) :: fraction
      real(wp) :: power
      integer :: k
      self%q = self%coordinate(fraction)
      self%v = self%rate(fraction)
      self%h = fraction * self%h
      power = 1.0_wp
      do k = 1, self%degree
         power = power * fraction
         self%cq(k) = self%cq(k) * power
         self%cv(k) = self%cv(k) * power
      end do
   end subroutine cut

end module common_dense_step
