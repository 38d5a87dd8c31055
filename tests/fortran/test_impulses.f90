!> Impulses between rigid bodies: a pile of boxes that is shaken obeys the law of unilateral contact with friction at
!> the velocities that come back, in the plane and in space, within the violation that was let pass.
program test_impulses
   use common_kinds, only : wp
   use common_status, only : status_ok
   use nonsmooth_impulses, only : along_normal, impulse_effort, impulse_problem, in_plane, in_space, problem_new, &
      problem_room, solve_impulses
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none (type, external)
   integer, parameter :: boxes = 6, steps = 200
   real(wp), parameter :: extent(3) = [0.6_wp, 0.3_wp, 1.0_wp]    !! along x, up, across [m]
   real(wp), parameter :: friction = 0.5_wp, gravity = 9.81_wp, step = 1.0e-3_wp, jolt = 3.0e-3_wp
   integer(c_int) :: status

   call shake(in_plane, 2)
   call shake(in_space, 4)
   print '(a)', 'impulses: all right'

contains

   !> Steps of a pile under a ground that moves, each from the velocities of the one before
   subroutine shake(directions, corners)
      integer, intent(in) :: directions
      integer, intent(in) :: corners               !! of a joint
      type(impulse_problem) :: problem
      type(impulse_effort) :: effort
      integer :: i, k, n, count, slid, parted
      real(wp) :: tolerance, t, found(3)

      n = merge(3, 6, directions == in_plane)
      call problem_new(boxes, directions, reshape([(k, k + 1, k = 1, boxes - 1)], [2, boxes - 1]), problem, status)
      if (status == status_ok) call problem_room(problem, corners * boxes, boxes, status)
      if (status /= status_ok) error stop 'no room'
      do k = 1, boxes
         call weigh(problem, n * problem%matrix%rank(k))
         do count = 1, corners
            call touch(problem, k, count, corners * (k - 1) + count)
         end do
      end do
      problem%points = corners * boxes
      problem%shift = 0.0_wp
      problem%friction = friction
      problem%impulse = 0.0_wp
      problem%rate = 0.0_wp
      tolerance = 1.0e-5_wp * gravity * step
      slid = 0
      parted = 0
      do count = 1, steps
         t = real(count, wp)
         problem%free(:) = problem%rate
         do k = 1, boxes
            associate (at => n * problem%matrix%rank(k))
               if (directions == in_plane) then
                  problem%free(at - 2:at - 1) = problem%free(at - 2:at - 1) &
                     + step * [7.0_wp * cos(0.5_wp * t), -gravity]
               else
                  problem%free(at - 5:at - 3) = problem%free(at - 5:at - 3) &
                     + step * [6.0_wp * cos(0.5_wp * t), -gravity, 5.0_wp * sin(0.33_wp * t)]
               end if
               if (mod(count, 5) > 0) cycle
               do i = at - n + 1, at
                  problem%free(i) = problem%free(i) + jolt * sin(7.0_wp * i + 3.0_wp * t**2)
               end do
            end associate
         end do
         call solve_impulses(problem, tolerance, 500, effort)
         if (.not. effort%converged) error stop 'no answer'
         do k = 1, problem%points
            found = law(problem, k)
            ! The tolerance is that of the impulses and, apart from these, of the velocities that follow.
            if (found(1) > 2.0_wp * tolerance) error stop 'the law is missed by more than is told'
            if (found(2) > tolerance) slid = slid + 1
            if (found(3) > tolerance) parted = parted + 1
         end do
      end do
      if (min(slid, parted) < 30) error stop 'hardly anything slides or opens: this tests nothing'
      ! One round from nothing does not find where points slide, and says by how much they miss
      problem%impulse = 0.0_wp
      problem%rate = 0.0_wp
      call solve_impulses(problem, tolerance, 1, effort)
      if (effort%rounds /= 1 .or. effort%factors < 1) error stop 'the effort is not counted'
      if (effort%converged) error stop 'one round is said to be enough'
      if (.not. effort%residual > tolerance) error stop 'a violation is not told'
   end subroutine shake

   subroutine weigh(problem, at)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: at                    !! last freedom of a box
      real(wp) :: mass
      mass = 2000.0_wp * product(extent)
      if (problem%directions == in_plane) then
         problem%mass(at - 2:at) = [mass, mass, mass / 12.0_wp * sum(extent(1:2)**2)]
      else
         problem%mass(at - 5:at) = [mass, mass, mass, mass / 12.0_wp * (extent(2)**2 + extent(3)**2), &
            mass / 12.0_wp * (extent(1)**2 + extent(3)**2), mass / 12.0_wp * (extent(1)**2 + extent(2)**2)]
      end if
   end subroutine weigh

   !> A corner of the joint below a box: with the one below it, or with the ground
   subroutine touch(problem, box, corner, k)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: box, corner, k
      real(wp) :: arm(3), way(3)
      integer :: d, side
      problem%node(:, k) = [0, problem%matrix%rank(box)]
      if (box > 1) problem%node(1, k) = problem%matrix%rank(box - 1)
      do d = 1, problem%directions
         way = 0.0_wp
         way(merge(2, merge(1, 3, d == 2), d == along_normal)) = 1.0_wp
         do side = 1, 2
            arm = 0.5_wp * extent * [real(merge(-1, 1, mod(corner, 2) == 0), wp), real(3 - 2 * side, wp), &
               real(merge(-1, 1, corner > 2), wp)]
            if (problem%directions == in_plane) then
               problem%row(:, side, d, k) = (2 * side - 3) * [way(1), way(2), arm(1) * way(2) - arm(2) * way(1)]
            else
               problem%row(:, side, d, k) = (2 * side - 3) * [way, arm(2) * way(3) - arm(3) * way(2), &
                  arm(3) * way(1) - arm(1) * way(3), arm(1) * way(2) - arm(2) * way(1)]
            end if
         end do
      end do
   end subroutine touch

   !> By how much a point misses the law [m/s], how fast it slides while it presses, and how fast it parts
   function law(problem, k) result(found)
      type(impulse_problem), intent(in) :: problem
      integer, intent(in) :: k
      real(wp) :: found(3)
      real(wp) :: w(3), p(3), slide, push
      integer :: d, side, at
      w = 0.0_wp
      p = 0.0_wp
      do d = 1, problem%directions
         do side = 1, 2
            at = problem%freedoms * problem%node(side, k)
            if (at > 0) w(d) = w(d) &
               + dot_product(problem%row(:, side, d, k), problem%rate(at - problem%freedoms + 1:at))
         end do
         p(d) = problem%impulse(d, k)
      end do
      slide = norm2(w(2:3))
      push = norm2(p(2:3))
      if (push > friction * p(1) * (1.0_wp + 1.0e-12_wp) + 1.0e-300_wp) error stop 'an impulse outside its cone'
      found = [-w(1), 0.0_wp, w(1)]
      if (p(1) > 0.0_wp) then
         found = [abs(w(1)), slide, 0.0_wp]
         ! What slides does so against its impulse, which is on the edge of the cone.
         if (push < 0.999999_wp * friction * p(1)) found(1) = max(found(1), slide)
         if (push > 0.0_wp) found(1) = max(found(1), norm2(w(2:3) + slide * p(2:3) / push))
      end if
   end function law

end program test_impulses
