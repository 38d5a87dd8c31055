!> What the joints must carry during a run of the one integrator (rocking_response): within a step, at a state, and at rest.
module rocking_demand
   use common_dense_step, only : dense_step
   use common_kinds, only : wp
   use rocking_equation, only : equation_of_motion
   use rocking_rocker, only : side_index
   use rocking_uplift, only : find_uplift
   use rocking_watch, only : joint_demand
   implicit none
   private
   public :: demand_at, look_within, look_at_rest

contains

   !> What they must carry within the first part of the last step, and when a condition fails there first
   subroutine look_within(problem, step, every, part, found)
      type(equation_of_motion), intent(in) :: problem
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: every  !! longest time between two looks [s]
      real(wp), intent(in) :: part   !! of the step
      type(joint_demand), intent(inout) :: found
      real(wp) :: x, last
      integer :: k, count
      logical :: slipped, left
      if (.not. allocated(problem%body%watch)) return
      count = max(1, min(1000, ceiling(part * step%h / every)))
      if (count > 1) then
         if (calm_step(problem, step, part, found)) return
      end if
      x = 0.0_wp
      do k = 1, count
         last = x
         x = part * real(k, wp) / real(count, wp)
         slipped = found%slips_at >= 0.0_wp
         left = found%leaves_at >= 0.0_wp
         call demand_within(problem, step, x, found)
         if (found%slips_at >= 0.0_wp .and. .not. slipped) then
            call first_failure(problem, step, last, x, .true., found%slips_at, found%slips)
         end if
         if (found%leaves_at >= 0.0_wp .and. .not. left) then
            call first_failure(problem, step, last, x, .false., found%leaves_at, found%leaves)
         end if
      end do
   end subroutine look_within

   !> Do the bounds of the joints show that nothing within the first part of a step changes a demand?
   pure function calm_step(problem, step, part, demand) result(answer)
      type(equation_of_motion), intent(in) :: problem
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: part
      type(joint_demand), intent(in) :: demand
      logical :: answer
      real(wp) :: q(2), v(2), horizontal(2), vertical(2)
      answer = .false.
      if (problem%ground%has_harmonics()) return
      call problem%ground%value_at(problem%segment, step%t, horizontal(1), vertical(1))
      call problem%ground%value_at(problem%segment, step%t + part * step%h, horizontal(2), vertical(2))
      ! no polynomial leaves its first value by more than the sum of the sizes of its other coefficients
      v = step%cv(0) + sum(abs(step%cv(1:step%degree))) * [-1.0_wp, 1.0_wp]
      if (v(1) * v(2) > 0.0_wp) then
         q = [min(step%cq(0), step%q), max(step%cq(0), step%q)]
         v = [minval(abs(v)), maxval(abs(v))]
      else
         q = step%cq(0) + sum(abs(step%cq(1:step%degree))) * [-1.0_wp, 1.0_wp]
         v = [0.0_wp, maxval(abs(v))]
      end if
      answer = problem%body%watch%changes_nothing_between(side_index(problem%side), q, v, horizontal, vertical, demand)
   end function calm_step

   !> Time and joint at which a condition fails first between two fractions of a step: it holds at the first, and fails at the last
   subroutine first_failure(problem, step, first, last, slides, time, joint)
      type(equation_of_motion), intent(in) :: problem
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: first, last
      logical, intent(in) :: slides       !! friction; else the thrust line
      real(wp), intent(out) :: time       !! [s]
      integer, intent(inout) :: joint     !! as it fails at the last fraction
      type(joint_demand) :: probe
      real(wp) :: low, high, middle
      integer :: n
      low = first
      high = last
      do n = 1, 40
         middle = 0.5_wp * (low + high)
         if ((high - low) * step%h <= 4.0_wp * spacing(step%t + step%h)) exit
         probe = joint_demand()
         call demand_within(problem, step, middle, probe)
         if (merge(probe%slips_at, probe%leaves_at, slides) >= 0.0_wp) then
            high = middle
            joint = merge(probe%slips, probe%leaves, slides)
         else
            low = middle
         end if
      end do
      time = step%t + high * step%h
   end subroutine first_failure

   !> What the joints must carry at a fraction of a step
   subroutine demand_within(problem, step, x, demand)
      type(equation_of_motion), intent(in) :: problem
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: x
      type(joint_demand), intent(inout) :: demand
      call demand_at(problem, step%t + x * step%h, step%coordinate(x), step%rate(x), demand)
   end subroutine demand_within

   !> What the joints must carry at a time of the present segment; nothing where they are not watched
   subroutine demand_at(problem, t, q, v, demand)
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: t  !! [s]
      real(wp), intent(in) :: q  !! rotation [rad]
      real(wp), intent(in) :: v  !! its rate [rad/s]
      type(joint_demand), intent(inout) :: demand
      real(wp) :: horizontal, vertical
      integer :: i
      if (.not. allocated(problem%body%watch)) return
      i = side_index(problem%side)
      call problem%ground%value_at(problem%segment, t, horizontal, vertical)
      if (problem%body%watch%restraints == 0) then
         call problem%body%watch%check_demand(i, q, v, horizontal, vertical, [real(wp) ::], t, demand)
         return
      end if
      block
         real(wp) :: pull(problem%body%watch%restraints)
         call problem%body%held%find_forces(i, q, v, problem%memory, pull)
         call problem%body%watch%check_demand(i, q, v, horizontal, vertical, pull, t, demand)
      end block
   end subroutine demand_at

   !> Does the resting structure slide, or open elsewhere, before a time? It does so as another mechanism would rise
   subroutine look_at_rest(problem, from, until, found)
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: from, until  !! [s]
      type(joint_demand), intent(inout) :: found
      call first_above(problem, from, until, problem%body%watch%slides, found%slips_at)
      call first_above(problem, from, until, problem%body%watch%opens, found%leaves_at)
   end subroutine look_at_rest

   !> First time at which the ground of the present segment exceeds an acceleration of a side, where none was found before
   subroutine first_above(problem, from, until, limit, time)
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: from, until  !! [s]
      real(wp), intent(in) :: limit(2)     !! of the sides +1 and -1 [m/s^2]
      real(wp), intent(inout) :: time      !! below 0: not found [s]
      type(equation_of_motion) :: other
      real(wp) :: when
      integer :: side
      if (all(limit >= huge(1.0_wp)) .or. time >= 0.0_wp) return
      other%body => problem%body
      other%ground = problem%ground
      other%segment = problem%segment
      other%rest_dv = limit
      other%rest_dh = 1.0_wp
      call find_uplift(other, from, until, when, side)
      if (side /= 0) time = when
   end subroutine first_above

end module rocking_demand
