!> The blow when open joints close: velocities after an impact without rebound at all joints of a section.
!>
!> Moreau 1988, "Unilateral contact and dry friction in finite freedom dynamics": of all velocities at which no joint
!> overlaps or slides, the one after the impact is nearest, in kinetic energy, to that before. It is the solution of the
!> complementarity problem "an end of a joint presses or parts, never both", found here by block principal pivoting
!> (Portugal, Judice and Vicente 1994) on the impulses of the joints.
module mechanism_blow
   use common_kinds, only : wp
   use common_status, only : status_ok, status_bad_index, status_no_pattern, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: inelastic_blow

   integer, parameter :: forces = 3          ! of a joint: press at one end, at the other, shear
   integer, parameter :: most_rounds = 2000
   integer, parameter :: bold_rounds = 10     ! exchanges of all wrong forces at once before one at a time
   real(wp), parameter :: ridge = 1.0e-12_wp ! over the mean diagonal: joints may hold each other in more ways than one
   real(wp), parameter :: wrong = 1.0e-9_wp  ! of the greatest impulse or velocity: a sign that counts

   interface
      subroutine dposv(uplo, n, nrhs, a, lda, b, ldb, info)
         import :: wp
         implicit none (type, external)
         character, intent(in) :: uplo
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: info
      end subroutine dposv
   end interface

contains

   !> Velocities x, y, spin of all blocks after all joints close at once, without rebound and without sliding
   subroutine inelastic_blow(mass, inertia, centroid, side, ends, normal, tangent, before, after, status)
      real(wp), intent(in) :: mass(:)          !! (n) blocks [kg]
      real(wp), intent(in) :: inertia(:)       !! (n) about the centroids [kg m^2]
      real(wp), intent(in) :: centroid(:, :)   !! (2, n) [m]
      integer(c_int), intent(in) :: side(:, :) !! (2, joints) blocks on both sides, 1 to n, 0 for the ground
      real(wp), intent(in) :: ends(:, :, :)    !! (2, 2, joints) x, y of both ends of the joints [m]
      real(wp), intent(in) :: normal(:, :)     !! (2, joints) unit, into the first block
      real(wp), intent(in) :: tangent(:, :)    !! (2, joints) unit
      real(wp), intent(in) :: before(:, :)     !! (3, n) velocity x, y, spin
      real(wp), intent(out) :: after(:, :)     !! (3, n)
      integer(c_int), intent(out) :: status    !! status_no_pattern where no sign pattern was found
      real(wp), allocatable :: rows(:, :), gram(:, :), load(:), impulse(:), parting(:), root(:), reduced(:, :), x(:)
      logical, allocatable :: pressed(:), free(:), bad(:)
      integer, allocatable :: index(:)
      real(wp) :: scale_impulse, scale_parting
      integer :: n, columns, round, fewest, bold, stat, j, k, info, worst, pressing

      after = 0.0_wp
      n = 3 * size(mass)
      columns = forces * size(side, 2)
      status = status_bad_index
      if (any(side < 0) .or. any(side > size(mass))) return
      allocate (rows(n, columns), gram(columns, columns), load(columns), impulse(columns), parting(columns), &
         root(n), reduced(columns, columns), x(columns), index(columns), pressed(columns), free(columns), &
         bad(columns), stat=stat)
      status = status_out_of_memory
      if (stat /= 0) return

      call rows_of(mass, inertia, centroid, side, ends, normal, tangent, rows)
      do k = 1, size(mass)
         root(3 * k - 2:3 * k) = sqrt([mass(k), mass(k), inertia(k)])
         after(:, k) = root(3 * k - 2:3 * k) * before(:, k)
      end do
      do k = 1, columns
         load(k) = 0.0_wp
         do j = 1, size(mass)
            load(k) = load(k) + dot_product(rows(3 * j - 2:3 * j, k), after(:, j))
         end do
         do j = 1, k
            gram(j, k) = dot_product(rows(:, j), rows(:, k))
            gram(k, j) = gram(j, k)
         end do
         gram(k, k) = gram(k, k) * (1.0_wp + ridge)
         free(k) = mod(k, forces) == 0
      end do
      pressed(:) = .true.
      fewest = columns + 1
      bold = bold_rounds
      status = status_no_pattern
      do round = 1, most_rounds
         pressing = 0
         do k = 1, columns
            if (.not. pressed(k)) cycle
            pressing = pressing + 1
            index(pressing) = k
         end do
         do k = 1, pressing
            reduced(:pressing, k) = gram(index(:pressing), index(k))
            x(k) = -load(index(k))
         end do
         impulse(:) = 0.0_wp
         if (pressing > 0) then
            call dposv('L', pressing, 1, reduced, columns, x, columns, info)
            if (info /= 0) return
            impulse(index(:pressing)) = x(:pressing)
         end if
         do k = 1, columns
            parting(k) = load(k) + dot_product(gram(:, k), impulse)
         end do
         scale_impulse = maxval(abs(impulse))
         scale_parting = maxval(abs(load))
         bad(:) = .not. free .and. merge(impulse < -wrong * scale_impulse, parting < -wrong * scale_parting, pressed)
         if (.not. any(bad)) exit
         if (count(bad) < fewest) then
            fewest = count(bad)
            bold = bold_rounds
         else
            bold = bold - 1
         end if
         if (bold < 0) then  ! one at a time ends always (Murty)
            worst = findloc(bad, .true., dim=1, back=.true.)
            bad(:) = .false.
            bad(worst) = .true.
         end if
         pressed(:) = pressed .neqv. bad
      end do
      if (round > most_rounds) return
      do k = 1, n
         after(mod(k - 1, 3) + 1, (k + 2) / 3) = before(mod(k - 1, 3) + 1, (k + 2) / 3) &
            + dot_product(rows(k, :), impulse) / root(k)
      end do
      status = status_ok
   end subroutine inelastic_blow

   !> Velocity of a unit impulse of each force of each joint, times the roots of mass and inertia
   pure subroutine rows_of(mass, inertia, centroid, side, ends, normal, tangent, rows)
      real(wp), intent(in) :: mass(:)
      real(wp), intent(in) :: inertia(:)
      real(wp), intent(in) :: centroid(:, :)
      integer(c_int), intent(in) :: side(:, :)
      real(wp), intent(in) :: ends(:, :, :)
      real(wp), intent(in) :: normal(:, :)
      real(wp), intent(in) :: tangent(:, :)
      real(wp), intent(out) :: rows(:, :)  !! (3 n, 3 joints): velocity of a unit impulse, times the root of the mass
      real(wp) :: arm(2), along(2), root(3), point(2)
      integer :: j, k, f, first, column

      rows = 0.0_wp
      do j = 1, size(side, 2)
         do k = 1, 2
            if (side(k, j) == 0) cycle
            first = 3 * (side(k, j) - 1)
            root = sqrt([mass(side(k, j)), mass(side(k, j)), inertia(side(k, j))])
            do f = 1, forces
               column = forces * (j - 1) + f
               along = merge(tangent(:, j), normal(:, j), f == 3)
               point = ends(:, merge(2, 1, f == 2), j)
               arm = point - centroid(:, side(k, j))
               ! on the first block as the joint points, on the second against it
               rows(first + 1:first + 3, column) = rows(first + 1:first + 3, column) + merge(1.0_wp, -1.0_wp, k == 1) &
                  * [along, arm(1) * along(2) - arm(2) * along(1)] / root
            end do
         end do
      end do
   end subroutine rows_of

end module mechanism_blow
