!> Corners that crush, in the plane: a joint whose pressure is bounded by a strength f_c.
!>
!> Forces f_1 and f_2 at the ends of a stretch of length w have the resultant N within w, and a pressure of f_c at most carries it if it
!> is no nearer to an end than N / 2 f_c:
!>
!>    f_1, f_2 >= N^2 / (2 F),   N = f_1 + f_2 <= F = f_c w.
!>
!> For F without limit that is a joint without tension. The forces of springs k with gaps g are the admissible ones nearest to -k g:
!> those of a potential, since the set is convex. A hinge so moves inward by N / 2 f_c, as in limit analysis; at N = F the joint yields
!> altogether. What crushing takes is given back when the joint closes again: the law has no memory.
module dem_crushing
   use common_kinds, only : wp
   use dem_contacts, only : contact_pair, overlap
   use dem_joint, only : joint_law, spring_share
   implicit none
   private
   public :: crush_corners, press_within

contains

   !> Gaps at which springs have the forces of a joint that crushes, in place of those measured
   pure subroutine crush_corners(law, pair, now)
      type(joint_law), intent(in) :: law
      type(contact_pair), intent(inout) :: pair
      type(overlap), intent(inout) :: now
      real(wp) :: stiffness(2), trial(2), force(2), crushed(2)
      integer :: i
      pair%crushed = 0.0_wp
      if (pair%joint == 0 .or. pair%careful .or. .not. now%width > 0.0_wp) then
         pair%point%crushed = 0.0_wp
         return
      end if
      do i = 1, 2
         stiffness(i) = law%normal_stiffness * merge(pair%point(i)%length, 0.5_wp * now%width, pair%point(i)%closed)
      end do
      trial = -stiffness * now%gap
      force = 0.0_wp
      if (any(trial > 0.0_wp)) call press_within(trial, law%strength * now%width, force)
      crushed = max((trial - force) / stiffness, 0.0_wp)
      now%elastic = spring_share((force - pair%point%spring_n) / stiffness, crushed - pair%point%crushed, now%gap >= 0.0_wp)
      pair%point%crushed = crushed
      if (.not. any(trial > 0.0_wp)) return
      do i = 1, 2
         if (.not. abs(force(i) - trial(i)) > 0.0_wp) cycle
         now%gap(i) = -force(i) / stiffness(i)
         pair%crushed = pair%crushed + force(i) * (trial(i) - force(i)) / stiffness(i)
      end do
   end subroutine crush_corners

   !> The admissible forces nearest to trial ones. With D = (f_1 - f_2) / 2 they are |D| <= N (1 - N / F) / 2, and on that edge the
   !> distance is convex in N
   pure subroutine press_within(trial, most, force)
      real(wp), intent(in) :: trial(2)              !! [N]
      real(wp), intent(in) :: most                  !! F [N]
      real(wp), intent(out) :: force(2)             !! [N]
      real(wp), parameter :: fine = 1.0e-15_wp      !! of F
      integer, parameter :: most_steps = 100
      real(wp) :: n, skew, x, low, high, slope, bend, next, half
      integer :: k
      n = sum(trial)
      skew = 0.5_wp * (trial(1) - trial(2))
      force = trial
      if (n >= 0.0_wp .and. n <= most .and. abs(skew) <= 0.5_wp * n * (1.0_wp - n / most)) return
      force = 0.0_wp
      if (.not. maxval(trial) > 0.0_wp) return
      force = 0.5_wp * most
      if (minval(trial) >= 0.5_wp * most) return
      low = 0.0_wp
      high = most
      next = max(0.0_wp, min(most, maxval(trial)))
      do k = 1, most_steps
         x = next / most
         slope = next - n + (next * (1.0_wp - x) - 2.0_wp * abs(skew)) * (1.0_wp - 2.0_wp * x)
         bend = 1.0_wp + (1.0_wp - 2.0_wp * x)**2 + 2.0_wp / most * (2.0_wp * abs(skew) - next * (1.0_wp - x))
         if (slope > 0.0_wp) high = next
         if (slope < 0.0_wp) low = next
         if (.not. abs(slope) > fine * bend * most) exit
         next = next - slope / bend
         if (.not. (next > low .and. next < high)) next = 0.5_wp * (low + high)
         if (high - low <= fine * most) exit
      end do
      half = 0.5_wp * next
      skew = sign(half * (1.0_wp - next / most), skew)
      force = [half + skew, half - skew]
   end subroutine press_within

end module dem_crushing
