!> Where within a step the rotation or its rate passes a value: roots of the dense output.
module rocking_crossings
   use common_dense_step, only : dense_step
   use common_kinds, only : wp
   implicit none
   private
   public :: impact_fraction, turning_fraction, crossing_fraction

contains

   !> Fraction of the step at which q falls through zero, or 0 where it does not
   pure function impact_fraction(step, q, v) result(s)
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: q  !! at the start
      real(wp), intent(in) :: v  !! at the start
      real(wp) :: s
      real(wp) :: low, high
      integer :: k

      s = 0.0_wp
      high = 1.0_wp
      if (step%q > 0.0_wp) then
         if (.not. (v < 0.0_wp .and. step%v > 0.0_wp)) return
         high = turning_fraction(step)  ! a dip that came back within the step
         if (step%coordinate(high) > 0.0_wp) return
      end if
      low = 0.0_wp
      if (q <= 0.0_wp) then
         ! q/s is positive just after the start; find its last sign change
         low = 1.0_wp
         do k = 1, 40
            low = 0.5_wp * low
            if (step%coordinate(low * high) > 0.0_wp) exit
         end do
         low = low * high
         if (step%coordinate(low) <= 0.0_wp) then
            s = 1.0_wp
            return
         end if
      end if
      s = root_between(step%cq, step%degree, 0.0_wp, low, high)
   end function impact_fraction

   !> Fraction of the step at which the rate changes sign
   pure function turning_fraction(step) result(s)
      type(dense_step), intent(in) :: step
      real(wp) :: s
      s = root_between(step%cv, step%degree, 0.0_wp, 0.0_wp, 1.0_wp)
   end function turning_fraction

   !> Fraction of the step at which q first rises through a level, or 0 where it does not: also where it is back below
   !> at the end
   pure function crossing_fraction(step, q, v, level) result(s)
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: q  !! at the start, below the level
      real(wp), intent(in) :: v  !! at the start
      real(wp), intent(in) :: level
      real(wp) :: s
      real(wp) :: last

      s = 0.0_wp
      last = 1.0_wp
      if (step%q < level) then
         if (.not. (v > 0.0_wp .and. step%v <= 0.0_wp) .or. max(q, step%q) + 2.0_wp * v * step%h < level) return
         last = turning_fraction(step)
         if (step%coordinate(last) < level) return
      end if
      s = root_between(step%cq, step%degree, level, 0.0_wp, last)
   end function crossing_fraction

   !> Where a polynomial passes a level, to rounding: Newton's method from the root of the parabola with its slope at
   !> the start and its values at both ends, by halves where it leaves the bracket or does not converge
   pure function root_between(c, degree, level, start, finish) result(s)
      real(wp), intent(in) :: c(0:)     !! coefficients of the powers
      integer, intent(in) :: degree
      real(wp), intent(in) :: level
      real(wp), intent(in) :: start     !! value differs from the level in sign from that at finish
      real(wp), intent(in) :: finish
      real(wp) :: s
      !> Newton's error after a change is its square times curvature over slope
      real(wp), parameter :: enough = 1.0e-10_wp
      real(wp) :: low, high, f, f_low, slope, bend, change, wide
      logical :: above
      integer :: j

      low = start
      high = finish
      call polynomial(high, f, slope)
      call polynomial(low, f_low, slope)
      above = f_low > 0.0_wp
      s = high
      wide = 2.0_wp * (high - low)
      ! the ends are of unlike sign: of both roots that by the sum without cancellation, or the other, lies between
      bend = (f - f_low) / (high - low) - slope
      change = sqrt(max(slope**2 - 4.0_wp * bend * f_low / (high - low), 0.0_wp))
      change = low - 2.0_wp * f_low / (slope + merge(-change, change, above)) - high
      do j = 1, 100
         if (f == 0.0_wp) exit
         if ((f > 0.0_wp) .eqv. above) then
            low = s
         else
            high = s
         end if
         ! Newton's method converges where each change is less than half of that before.
         if (.not. (s + change > low .and. s + change < high .and. abs(change) <= 0.5_wp * wide)) then
            change = 0.5_wp * (low + high) - s
         end if
         s = s + change
         if (abs(change) <= enough * s .and. j > 1) exit
         wide = abs(change)
         call polynomial(s, f, slope)
         change = -f / slope  ! also where the slope is zero: the change then lies outside
      end do

   contains

      !> Value above the level, and slope
      pure subroutine polynomial(x, value, derivative)
         real(wp), intent(in) :: x
         real(wp), intent(out) :: value
         real(wp), intent(out) :: derivative
         integer :: k
         value = c(degree)
         derivative = 0.0_wp
         do k = degree - 1, 0, -1
            derivative = derivative * x + value
            value = value * x + c(k)
         end do
         value = value - level
      end subroutine polynomial

   end function root_between

end module rocking_crossings
