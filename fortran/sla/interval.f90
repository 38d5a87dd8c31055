!> Range of the load multiplier that an uncracked point in plane stress admits (thesis Eqs 4.4 to 4.6).
!>
!> With m the mean stress and r the radius of Mohr's circle every criterion here reads r <= alpha - beta m:
!> tension alpha = ft, beta = 1; compression alpha = fc, beta = -1; tension reduced by lateral compression,
!> s1/ft - s2/fc <= 1, alpha = ft fc / (ft + fc), beta = (fc - ft) / (fc + ft). That is a convex cone in
!> (m, (sx - sy)/2, txy), so a line of stresses sA + lambda sB stays inside on one interval at most. It may
!> be empty, which the thesis does not treat: then no multiplier can relieve the point.
module sla_interval
   use common_kinds, only : wp
   implicit none
   private
   public :: cone_interval, quadratic_interval, overload

contains

   !> Where a + 2 b lambda + c lambda^2 <= 0, c > 0; empty has lo > hi
   pure subroutine quadratic_interval(a, b, c, lo, hi)
      real(wp), intent(in) :: a, b, c
      real(wp), intent(out) :: lo
      real(wp), intent(out) :: hi
      real(wp) :: disc, q
      lo = huge(1.0_wp)
      hi = -huge(1.0_wp)
      disc = b**2 - a * c
      if (.not. disc >= 0.0_wp) return
      q = -(b + sign(sqrt(disc), b))     ! both roots without cancellation
      lo = q / c
      hi = lo
      if (abs(q) > 0.0_wp) hi = a / q
      if (lo > hi) then
         q = lo
         lo = hi
         hi = q
      end if
   end subroutine quadratic_interval

   !> The admissible interval; empty has lo > hi, an open end is +-huge
   pure subroutine cone_interval(alpha, beta, a, b, lo, hi)
      real(wp), intent(in) :: alpha   !! [Pa]
      real(wp), intent(in) :: beta
      real(wp), intent(in) :: a(3)    !! sx, sy, txy of the constant loads [Pa]
      real(wp), intent(in) :: b(3)    !! sx, sy, txy per unit multiplier [Pa]
      real(wp), intent(out) :: lo
      real(wp), intent(out) :: hi
      real(wp) :: ga, gb, da, db, q2, q1, q0, disc, q, x, y

      lo = -huge(1.0_wp)
      hi = huge(1.0_wp)
      ga = alpha - beta * 0.5_wp * (a(1) + a(2))   ! the margin g = ga + lambda gb must cover the radius
      gb = -beta * 0.5_wp * (b(1) + b(2))
      da = 0.5_wp * (a(1) - a(2))
      db = 0.5_wp * (b(1) - b(2))
      q2 = gb**2 - db**2 - b(3)**2
      q1 = 2.0_wp * (ga * gb - da * db - a(3) * b(3))
      q0 = ga**2 - da**2 - a(3)**2
      disc = q1**2 - 4.0_wp * q2 * q0
      if (q2 > 0.0_wp) then
         ! Along the axis of the cone: the line pierces each of its two halves once.
         q = -0.5_wp * (q1 + sign(sqrt(max(disc, 0.0_wp)), q1))
         x = q / q2
         y = x
         if (q /= 0.0_wp) y = q0 / q
         if (gb > 0.0_wp) then
            lo = max(x, y)
         else
            hi = min(x, y)
         end if
      else if (q2 < 0.0_wp) then
         if (disc >= 0.0_wp) then
            q = -0.5_wp * (q1 + sign(sqrt(disc), q1))
            x = q / q2
            y = x
            if (q /= 0.0_wp) y = q0 / q
            if (ga + 0.5_wp * (x + y) * gb >= 0.0_wp) then
               lo = min(x, y)
               hi = max(x, y)
               return
            end if
         end if
         lo = huge(1.0_wp)
         hi = -huge(1.0_wp)
      else if (abs(q1) > 0.0_wp) then
         x = -q0 / q1                          ! thesis Eq. 4.6
         if (ga + x * gb < 0.0_wp) then
            lo = huge(1.0_wp)
            hi = -huge(1.0_wp)
         else if (q1 > 0.0_wp) then
            lo = x
         else
            hi = x
         end if
      else if (q0 < 0.0_wp .or. ga < 0.0_wp) then
         lo = huge(1.0_wp)
         hi = -huge(1.0_wp)
      end if
   end subroutine cone_interval

   !> By how much the criterion is exceeded, relative to alpha
   pure function overload(alpha, beta, s) result(excess)
      real(wp), intent(in) :: alpha, beta
      real(wp), intent(in) :: s(3)
      real(wp) :: excess
      excess = (hypot(0.5_wp * (s(1) - s(2)), s(3)) + beta * 0.5_wp * (s(1) + s(2))) / alpha - 1.0_wp
   end function overload

end module sla_interval
