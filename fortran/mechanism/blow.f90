!> The impact when open joints close: velocities after an impact without rebound at all joints of a section.
!>
!> Moreau 1988, "Unilateral contact and dry friction in finite freedom dynamics": of all velocities at which no joint
!> overlaps or slides, the one after the impact is nearest, in kinetic energy, to that before. Impulses press and shear
!> at both ends of each joint: the law of nonsmooth_impulses, with friction that never slips.
module mechanism_blow
   use common_kinds, only : wp
   use common_status, only : status_ok, status_bad_index, status_no_pattern, status_out_of_memory
   use nonsmooth_impulses, only : along_normal, along_tangent, impulse_effort, impulse_problem, in_plane, no_sliding, &
      problem_new, problem_room, solve_impulses
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: inelastic_blow

   !> Weights over the mass that a point feels: large, so that long thin arches take few rounds
   real(wp), parameter :: heavy = 1.0e5_wp
   !> Violation that is sought, and that suffices, of the speed before (root mean square): weights that have grown
   !> leave a rounding of as many times epsilon, 2e-9
   real(wp), parameter :: sought = 1.0e-11_wp, enough = 1.0e-8_wp
   integer, parameter :: most_rounds = 200

contains

   !> Velocities x, y, spin of all blocks after all joints close at once, without rebound and without sliding
   subroutine inelastic_blow(mass, inertia, centroid, side, ends, normal, tangent, before, after, status)
      real(wp), intent(in) :: mass(:)          !! (n) blocks [kg]
      real(wp), intent(in) :: inertia(:)       !! (n) about the centroids [kg m^2]
      real(wp), intent(in) :: centroid(:, :)   !! (2, n) [m]
      integer(c_int), intent(in) :: side(:, :) !! (2, joints) blocks on both sides, 1 to n, 0 for the ground; not alike
      real(wp), intent(in), contiguous :: ends(:, :, :)    !! (2, 2, joints) x, y of both ends of the joints [m]
      real(wp), intent(in), contiguous :: normal(:, :)     !! (2, joints) unit, into the first block
      real(wp), intent(in), contiguous :: tangent(:, :)    !! (2, joints) unit
      real(wp), intent(in) :: before(:, :)     !! (3, n) velocity x, y, spin
      real(wp), intent(out) :: after(:, :)     !! (3, n)
      integer(c_int), intent(out) :: status    !! status_no_pattern where no impulses were found
      type(impulse_problem) :: problem
      type(impulse_effort) :: effort
      integer, allocatable :: link(:, :)
      real(wp) :: speed
      integer :: j, k, at, links, failed, both(2)

      after = 0.0_wp
      status = status_bad_index
      if (any(side < 0) .or. any(side > size(mass)) .or. any(side(1, :) == side(2, :))) return
      status = status_out_of_memory
      allocate (link(2, size(side, 2)), stat=failed)
      if (failed /= 0) return
      links = 0
      do j = 1, size(side, 2)
         if (any(side(:, j) == 0)) cycle
         links = links + 1
         link(:, links) = side(:, j)
      end do
      call problem_new(size(mass), in_plane, link(:, :links), problem, status)
      if (status /= status_ok) return
      call problem_room(problem, 2 * size(side, 2), size(side, 2), status)
      if (status /= status_ok) return
      problem%points = 2 * size(side, 2)
      problem%heavy = heavy
      do k = 1, size(mass)
         at = 3 * (problem%matrix%rank(k) - 1)
         problem%mass(at + 1:at + 3) = [mass(k), mass(k), inertia(k)]
         problem%free(at + 1:at + 3) = before(:, k)
      end do
      problem%rate(:) = problem%free
      do j = 1, size(side, 2)
         both = int(side(:, j))
         do k = 1, 2
            call add_contact(problem, 2 * (j - 1) + k, both, centroid, ends(:, k, j), normal(:, j), tangent(:, j))
         end do
      end do
      speed = sqrt(sum(problem%mass * problem%free**2) / sum(mass))
      call solve_impulses(problem, sought * speed, most_rounds, effort)
      status = status_no_pattern
      if (.not. effort%residual <= enough * speed) return
      do k = 1, size(mass)
         at = 3 * (problem%matrix%rank(k) - 1)
         after(:, k) = problem%rate(at + 1:at + 3)
      end do
      status = status_ok
   end subroutine inelastic_blow

   !> One end of a joint as contact point: on the first block it pushes as the joint points, on the second against it
   pure subroutine add_contact(problem, point, side, centroid, place, normal, tangent)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: point             !! its number
      integer, intent(in) :: side(2)           !! blocks, 0 for the ground
      real(wp), intent(in) :: centroid(:, :)   !! (2, n) of the blocks [m]
      real(wp), intent(in) :: place(2)         !! of the point [m]
      real(wp), intent(in) :: normal(2)        !! unit
      real(wp), intent(in) :: tangent(2)       !! unit
      real(wp) :: arm(2)
      integer :: k

      problem%friction(point) = no_sliding
      problem%shift(:, point) = 0.0_wp
      problem%impulse(:, point) = 0.0_wp
      problem%node(:, point) = 0
      problem%row(:, :, :, point) = 0.0_wp
      do k = 1, 2
         if (side(k) == 0) cycle
         problem%node(k, point) = problem%matrix%rank(side(k))
         arm = place - centroid(:, side(k))
         problem%row(:, k, along_normal, point) = merge(1.0_wp, -1.0_wp, k == 1) &
            * [normal, arm(1) * normal(2) - arm(2) * normal(1)]
         problem%row(:, k, along_tangent, point) = merge(1.0_wp, -1.0_wp, k == 1) &
            * [tangent, arm(1) * tangent(2) - arm(2) * tangent(1)]
      end do
   end subroutine add_contact

end module mechanism_blow
