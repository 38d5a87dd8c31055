!> When the ground lifts a structure that rests.
module rocking_uplift
   use common_kinds, only : wp, gravity
   use rocking_equation, only : equation_of_motion
   implicit none
   private
   public :: find_uplift, last_calm

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
               call find_crest(j, t0, t1, top)
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
      subroutine find_crest(j, first, last, top)
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
      end subroutine find_crest

      !> The first time at which side j is driven up, between a quiet and a driven time: by the false position, which
      !> straight lines need once, and halves where one end stays
      function crossing(j, quiet_time, driven_time) result(root)
         integer, intent(in) :: j
         real(wp), intent(in) :: quiet_time
         real(wp), intent(in) :: driven_time
         real(wp) :: root
         real(wp) :: low, high, middle, f(2), f_low, f_high
         integer :: n
         low = quiet_time
         high = driven_time
         f = drive(low)
         f_low = f(j)
         f = drive(high)
         f_high = f(j)
         do n = 1, 120
            if (high - low <= 2.0_wp * spacing(high)) exit
            middle = high - (high - low) * f_high / (f_high - f_low)
            ! A little to the driven side, so that the other end moves too.
            middle = min(middle + 2.0_wp * spacing(high), high - spacing(high))
            if (mod(n, 3) == 0 .or. middle <= low) middle = 0.5_wp * (low + high)
            f = drive(middle)
            if (f(j) > 0.0_wp) then
               high = middle
               f_high = f(j)
            else
               low = middle
               f_low = f(j)
            end if
         end do
         root = high
      end function crossing

   end subroutine find_uplift

   !> Last segment from `segment` on through whose samples the ground does not drive the resting structure
   pure function last_calm(problem, segment, until) result(calm)
      type(equation_of_motion), intent(in) :: problem  !! with a sampled ground motion
      integer, intent(in) :: segment                   !! at whose start the ground does not drive it
      real(wp), intent(in) :: until                    !! not past this time [s]
      integer :: calm                                  !! segment - 1 where it drives it there
      real(wp) :: weight, horizontal
      integer :: k

      calm = segment - 1
      do k = segment, problem%ground%segments
         if (problem%ground%break_time(k + 1) > until) exit
         associate (sample => problem%ground%samples(:, k + 1), scale => problem%ground%scale)
            horizontal = scale * sample(1)
            weight = 1.0_wp
            if (size(sample) > 1) weight = 1.0_wp + scale * sample(2) / gravity
         end associate
         if (any(problem%body%free .and. [-horizontal, horizontal] * problem%rest_dh &
            > problem%rest_dv * weight + problem%rest_hold)) exit
         calm = k
      end do
   end function last_calm

end module rocking_uplift
