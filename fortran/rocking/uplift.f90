!> When the ground lifts a structure that rests.
module rocking_uplift
   use common_kinds, only : wp, gravity
   use rocking_equation, only : equation_of_motion
   implicit none
   private
   public :: find_uplift

contains

   !> First time in [t, t_next] at which the ground lifts the resting structure, and the side it rocks to
   subroutine find_uplift(problem, t, t_next, when, side)
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: t
      real(wp), intent(in) :: t_next
      real(wp), intent(out) :: when
      integer, intent(out) :: side              !! 0 where it stays at rest
      real(wp) :: t0, t1, f0(2), f1(2), best, root, grid, top, at_top(2)
      integer :: j

      side = 0
      when = t_next
      ! Straight lines are tested at their ends; sines 32 times a cycle, and between where they come near.
      grid = problem%ground%shortest_period(problem%segment) / 32.0_wp
      t1 = t
      f1 = drive(t1)
      do while (t1 < t_next)
         t0 = t1
         f0 = f1
         t1 = min(t_next, t0 + grid)
         f1 = drive(t1)
         best = huge(best)
         do j = 1, 2
            if (f0(j) > 0.0_wp) then
               root = t0
            else if (f1(j) > 0.0_wp) then
               root = crossing(j, t0, t1)
            else
               if (grid >= huge(grid) / 64.0_wp .or. max(f0(j), f1(j)) < -0.02_wp &
                  * (problem%rest_dv(j) + problem%rest_hold(j))) cycle
               call crest(j, t0, t1, top)
               at_top = drive(top)
               if (at_top(j) <= 0.0_wp) cycle
               root = crossing(j, t0, top)
            end if
            if (root < best) then
               best = root
               side = 3 - 2 * j
            end if
         end do
         if (side /= 0) then
            when = best
            return
         end if
      end do

   contains

      !> Driving minus resisting moment of both sides at rest
      function drive(time) result(f)
         real(wp), intent(in) :: time
         real(wp) :: f(2)
         real(wp) :: horizontal, vertical
         call problem%ground%value_at(problem%segment, time, horizontal, vertical)
         f = [-horizontal, horizontal] * problem%rest_dh - problem%rest_dv * (1.0_wp + vertical / gravity) &
            - problem%rest_hold
         if (.not. all(problem%body%free)) f = merge(f, -huge(f), problem%body%free)
      end function drive

      !> Where the drive of side j is greatest between two times, by golden section
      subroutine crest(j, first, last, top)
         integer, intent(in) :: j
         real(wp), intent(in) :: first
         real(wp), intent(in) :: last
         real(wp), intent(out) :: top
         real(wp), parameter :: golden = 0.6180339887498949_wp
         real(wp) :: low, high, x, y, fx(2), fy(2)
         integer :: n
         low = first
         high = last
         do n = 1, 30
            x = high - golden * (high - low)
            y = low + golden * (high - low)
            fx = drive(x)
            fy = drive(y)
            if (fx(j) > fy(j)) then
               high = y
            else
               low = x
            end if
         end do
         top = 0.5_wp * (low + high)
      end subroutine crest

      !> The first time at which side j is driven up, between a quiet and a driven time
      function crossing(j, quiet_time, driven_time) result(root)
         integer, intent(in) :: j
         real(wp), intent(in) :: quiet_time
         real(wp), intent(in) :: driven_time
         real(wp) :: root
         real(wp) :: low, high, middle, f(2)
         integer :: n
         low = quiet_time
         high = driven_time
         do n = 1, 60
            middle = 0.5_wp * (low + high)
            f = drive(middle)
            if (f(j) > 0.0_wp) then
               high = middle
            else
               low = middle
            end if
         end do
         root = high
      end function crossing

   end subroutine find_uplift

end module rocking_uplift
