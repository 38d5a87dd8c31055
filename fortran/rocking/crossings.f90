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
      s = root_between(step, .false., 0.0_wp, low, high)
   end function impact_fraction

   !> Fraction of the step at which the rate changes sign
   pure function turning_fraction(step) result(s)
      type(dense_step), intent(in) :: step
      real(wp) :: s
      s = root_between(step, .true., 0.0_wp, 0.0_wp, 1.0_wp)
   end function turning_fraction

   !> Fraction of the step at which q rises through a level
   pure function crossing_fraction(step, level) result(s)
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: level
      real(wp) :: s
      s = root_between(step, .false., level, 0.0_wp, 1.0_wp)
   end function crossing_fraction

   !> bracket and takes a fifth of the evaluations of bisection. Returns the end beyond the level.
   pure function root_between(step, of_rate, level, start, finish) result(s)
      type(dense_step), intent(in) :: step
      logical, intent(in) :: of_rate     !! the rate, else the coordinate
      real(wp), intent(in) :: level
      real(wp), intent(in) :: start      !! value differs from the level in sign from that at finish
      real(wp), intent(in) :: finish
      real(wp) :: s
      real(wp) :: low, high, f_low, f_high, f, middle
      integer :: k, stayed

      low = start
      high = finish
      f_low = value(low)
      f_high = value(high)
      stayed = 0
      do k = 1, 100
         if (f_high == 0.0_wp .or. abs(high - low) <= 2.0_wp * spacing(high)) exit
         middle = high - f_high * (high - low) / (f_high - f_low)
         if (.not. (middle > low .and. middle < high) .or. mod(k, 8) == 0) middle = 0.5_wp * (low + high)
         if (middle <= low .or. middle >= high) exit
         f = value(middle)
         if ((f > 0.0_wp) .eqv. (f_low > 0.0_wp)) then
            low = middle
            f_low = f
            if (stayed == 1) f_high = 0.5_wp * f_high
            stayed = 1
         else
            high = middle
            f_high = f
            if (stayed == -1) f_low = 0.5_wp * f_low
            stayed = -1
         end if
      end do
      s = high

   contains

      pure function value(x) result(f)
         real(wp), intent(in) :: x
         real(wp) :: f
         if (of_rate) then
            f = step%rate(x) - level
         else
            f = step%coordinate(x) - level
         end if
      end function value

   end function root_between

end module rocking_crossings
