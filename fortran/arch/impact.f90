!> Impact of the four-hinge arch: the rate of the mirrored mechanism after the hinges close
!> (thesis 5.2.2, Eqs 5.3 and B.3a-e).
module arch_impact
   use common_kinds, only : wp
   use arch_four_hinge, only : normal
   use mechanism_impact, only : projected_restitution
   use common_small_solve, only : small_solve
   use common_status, only : status_ok, status_bad_geometry, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: impact_restitution

contains

   !> c_v by the momentum balance of the thesis, and by the workless-impulse projection.
   !>
   !> Thesis: external impulses at the points about which the next mechanism turns, momentum
   !> balance of the whole arch (B.3a-c), of the part left of joint B about the point opposite to
   !> hinge B (B.3d) and of the part right of joint C about the point opposite to hinge C (B.3e).
   !> Projection: see mechanism_impact; of size <= 1, because both mechanisms have the same mass.
   !> Either is negative where the mirrored mechanism would have to close further: the hinges do not reflect then.
   subroutine impact_restitution(mass, centroid, inertia, joint, hinge, opposite, thesis, projection, status)
      real(wp), intent(in) :: mass(:)         !! (n) voussoirs, left to right, symmetric about x = 0 [kg]
      real(wp), intent(in) :: centroid(:, :)  !! (2, n) [m]
      real(wp), intent(in) :: inertia(:)      !! (n) about the centroids [kg m^2]
      integer(c_int), intent(in) :: joint(4)  !! joints of A, B, C, D, 0 = left springing, n = right
      real(wp), intent(in) :: hinge(2, 4)     !! A, B, C, D [m]
      real(wp), intent(in) :: opposite(2, 4)  !! the other face of the same joints [m]
      real(wp), intent(out) :: thesis         !! c_v of Eqs B.3; may exceed 1 where A stands above the springing
      real(wp), intent(out) :: projection     !! c_v of the workless-impulse projection
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: before(:, :), after(:, :)  ! (3, n): velocity x, y, spin
      real(wp) :: next_left(2), next_right(2), a(5, 5), b(5)
      integer :: n, i, stat

      thesis = 0.0_wp
      projection = 0.0_wp
      n = size(mass)
      allocate (before(3, n), after(3, n), stat=stat)
      if (stat /= 0) then
         status = status_out_of_memory
         return
      end if
      call velocity_field(centroid, joint, hinge, before, status)
      if (status /= status_ok) return
      do i = 1, n
         after(:, i) = [-before(1, n + 1 - i), before(2, n + 1 - i), -before(3, n + 1 - i)]
      end do
      ! Before impact the links close, after it they open: both fields are those of opening.
      projection = projected_restitution(mass, inertia, before, after)

      next_left = [-hinge(1, 4), hinge(2, 4)]
      next_right = [-hinge(1, 1), hinge(2, 1)]
      ! Unknowns: impulse at the left (1, 2), at the right (3, 4), rate after over rate before (5).
      a = 0.0_wp
      a(1, [1, 3]) = 1.0_wp
      a(2, [2, 4]) = 1.0_wp
      a(3, 1:4) = [-next_left(2), next_left(1), -next_right(2), next_right(1)]
      a(4, 1:2) = [opposite(2, 2) - next_left(2), next_left(1) - opposite(1, 2)]
      a(5, 3:4) = [opposite(2, 3) - next_right(2), next_right(1) - opposite(1, 3)]
      a(1:3, 5) = -momentum(after, 1, n, [0.0_wp, 0.0_wp])
      b(1:3) = -momentum(before, 1, n, [0.0_wp, 0.0_wp])
      a(4, 5) = -spin_momentum(after, 1, int(joint(2)), opposite(:, 2))
      b(4) = -spin_momentum(before, 1, int(joint(2)), opposite(:, 2))
      a(5, 5) = -spin_momentum(after, int(joint(3)) + 1, n, opposite(:, 3))
      b(5) = -spin_momentum(before, int(joint(3)) + 1, n, opposite(:, 3))
      call small_solve(a, b, status)
      if (status == status_ok) thesis = -b(5)

   contains

      !> Linear momentum and moment of momentum about a point, of voussoirs first..last
      pure function momentum(u, first, last, about) result(total)
         real(wp), intent(in) :: u(:, :)
         integer, intent(in) :: first
         integer, intent(in) :: last
         real(wp), intent(in) :: about(2)
         real(wp) :: total(3), arm(2)
         integer :: k
         total = 0.0_wp
         do k = first, last
            arm = centroid(:, k) - about
            total(1:2) = total(1:2) + mass(k) * u(1:2, k)
            total(3) = total(3) + mass(k) * (arm(1) * u(2, k) - arm(2) * u(1, k)) + inertia(k) * u(3, k)
         end do
      end function momentum

      pure function spin_momentum(u, first, last, about) result(spin)
         real(wp), intent(in) :: u(:, :)
         integer, intent(in) :: first
         integer, intent(in) :: last
         real(wp), intent(in) :: about(2)
         real(wp) :: spin, total(3)
         total = momentum(u, first, last, about)
         spin = total(3)
      end function spin_momentum

   end subroutine impact_restitution

   !> Velocities of the voussoirs for a unit rate of link AB in the undeformed arch
   subroutine velocity_field(centroid, joint, hinge, field, status)
      real(wp), intent(in) :: centroid(:, :)
      integer(c_int), intent(in) :: joint(4)
      real(wp), intent(in) :: hinge(2, 4)
      real(wp), intent(out) :: field(:, :)
      integer(c_int), intent(out) :: status
      real(wp) :: spin(3), velocity_b(2), bc(2), dc(2), denominator, pivot(2), pivot_velocity(2)
      integer :: k, link

      field = 0.0_wp
      status = status_bad_geometry
      bc = hinge(:, 3) - hinge(:, 2)
      dc = hinge(:, 3) - hinge(:, 4)
      velocity_b = normal(hinge(:, 2) - hinge(:, 1))
      denominator = dot_product(normal(dc), bc)
      if (abs(denominator) <= 1.0e-12_wp * norm2(bc) * norm2(dc)) return
      spin(1) = 1.0_wp
      spin(3) = dot_product(velocity_b, bc) / denominator
      spin(2) = dot_product(velocity_b, dc) / denominator  ! dot(normal(bc), dc) = -denominator
      do k = joint(1) + 1, joint(4)
         link = 1
         if (k > joint(2)) link = 2
         if (k > joint(3)) link = 3
         pivot = hinge(:, merge(4, link, link == 3))
         pivot_velocity = 0.0_wp
         if (link == 2) pivot_velocity = velocity_b
         field(1:2, k) = pivot_velocity + spin(link) * normal(centroid(:, k) - pivot)
         field(3, k) = spin(link)
      end do
      status = status_ok
   end subroutine velocity_field

end module arch_impact
