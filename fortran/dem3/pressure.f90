!> Faces that crush, in space: the forces of a contact whose pressure is bounded by a strength f_c.
!>
!> Springs k_i at the corners of the polygon that two faces share are in series with a face of overlap g over it, whose pressure is
!>
!>    p = min(max(K g, 0), f_c),
!>
!> with K much greater than the stiffness of the springs. A fan of triangles from the mean of the corners shares the pressure among
!> the corners, with shape functions that are linear in each triangle, so that the resultant keeps its place. With t_i the forces of
!> the springs alone, the overlaps are the least of the convex function
!>
!>    D(g) = int psi(g) dA + sum k_i g_i^2 / 2 - t_i g_i,   psi' = p,
!>
!> by Newton's method, and the forces are t_i - k_i g_i: those of a potential. For K without limit they are the admissible forces
!> nearest to those of the springs, as in dem_crushing, and for f_c without limit those of the springs. Integrals are exact. What
!> crushing takes is given back when the contact closes again: the law has no memory.
module dem3_pressure
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: face_room, face_room_new, press_face

   !> A face of n corners: its forces, and the room in which they are found
   type :: face_room
      real(wp), allocatable :: corner(:, :)      !! (3, n) in order around the polygon [m]
      real(wp), allocatable :: spring(:)         !! (n) k_i [N/m]
      real(wp), allocatable :: trial(:)          !! (n) t_i, negative where a corner is open [N]
      real(wp), allocatable :: overlap(:)        !! (n) g at the corners, from where the search starts [m]
      real(wp), allocatable :: force(:)          !! (n) [N]
      real(wp), allocatable :: gap(:)            !! (n) at which the springs alone have these forces [m]
      real(wp), allocatable :: elastic(:)        !! (n) see spring_share
      real(wp), allocatable :: slope(:), way(:), next(:)   !! (n)
      real(wp), allocatable :: bend(:, :)        !! (n, n)
   end type face_room

   real(wp), parameter :: stiffer = 1.0e4_wp     !! K over the stiffness of the springs per area

contains

   !> Room for a face of so many corners
   pure subroutine face_room_new(corners, room, status)
      integer, intent(in) :: corners
      type(face_room), intent(out) :: room
      integer(c_int), intent(out) :: status      !! status_out_of_memory, else ok
      integer :: failed
      allocate (room%corner(3, corners), room%spring(corners), room%trial(corners), room%overlap(corners), room%force(corners), &
         room%gap(corners), room%elastic(corners), room%slope(corners), room%way(corners), room%next(corners), &
         room%bend(corners, corners), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
   end subroutine face_room_new

   !> Forces of the corners of a polygon
   pure subroutine press_face(stiffness, strength, room, energy, converged)
      real(wp), intent(in) :: stiffness          !! of the springs per area [Pa/m]
      real(wp), intent(in) :: strength           !! [Pa]
      type(face_room), intent(inout) :: room     !! corners, springs, their forces alone and overlaps; has the forces then
      real(wp), intent(out) :: energy            !! of the face, without that of the springs [J]
      logical, intent(out) :: converged
      real(wp), parameter :: fine = 1.0e-9_wp    !! of the greatest force that presses
      real(wp), parameter :: coarse = 1.0e-6_wp  !! of the same: rounding may keep the search from the fine one, not from this
      real(wp), parameter :: rounding = 1.0e-13_wp   !! of the greatest force
      integer, parameter :: most_rounds = 60, most_cuts = 40
      real(wp) :: value, next_value, share, descent, tolerance
      integer :: k, cut
      energy = 0.0_wp
      converged = .true.
      associate (spring => room%spring, trial => room%trial, overlap => room%overlap, force => room%force, &
                 slope => room%slope, way => room%way, next => room%next, bend => room%bend)
         force = 0.0_wp
         if (.not. maxval(trial) > 0.0_wp) then
            overlap = trial / spring
            return
         end if
         tolerance = max(fine * maxval(trial), rounding * maxval(abs(trial)))
         call evaluate(overlap, value, energy, slope, bend)
         do k = 1, most_rounds
            if (maxval(abs(slope)) <= tolerance) exit
            next = -slope
            call solve(bend, next, way)
            descent = dot_product(slope, way)
            share = 1.0_wp
            do cut = 1, most_cuts
               next = overlap + share * way
               call evaluate(next, next_value, energy, slope, bend)
               if (next_value <= value + 1.0e-4_wp * share * descent + rounding * abs(value)) exit
               share = 0.5_wp * share
            end do
            overlap = next
            value = next_value
         end do
         converged = maxval(abs(slope)) <= max(tolerance, coarse * maxval(trial))
         force = max(trial - spring * overlap, 0.0_wp)
      end associate

   contains

      !> D, its part of the face, its slope and its bend
      pure subroutine evaluate(g, whole, face, gradient, second)
         real(wp), intent(in) :: g(:)
         real(wp), intent(out) :: whole          !! [J]
         real(wp), intent(out) :: face           !! [J]
         real(wp), intent(out) :: gradient(:)    !! [N]
         real(wp), intent(out) :: second(:, :)   !! [N/m]
         real(wp) :: middle(3), one(3), other(3), normal(3), pressed(3), beyond(3), push(3), area
         real(wp) :: all_of(3, 3), crushed(3, 3), part(3, 3)
         integer :: i, j, n
         n = size(g)
         middle = sum(room%corner, dim=2) / n
         face = 0.0_wp
         gradient = room%spring * g - room%trial
         second = 0.0_wp
         do i = 1, n
            second(i, i) = room%spring(i)
         end do
         do i = 1, n
            j = merge(1, i + 1, i == n)
            one = room%corner(:, i) - middle
            other = room%corner(:, j) - middle
            normal = [one(2) * other(3) - one(3) * other(2), one(3) * other(1) - one(1) * other(3), &
               one(1) * other(2) - one(2) * other(1)]
            area = 0.5_wp * sqrt(sum(normal**2))
            pressed = stiffer * stiffness * [sum(g) / n, g(i), g(j)]
            beyond = pressed - strength
            if (.not. any(pressed > 0.0_wp)) cycle
            all_of = second_moments(pressed, area)
            crushed = second_moments(beyond, area)
            push = matmul(all_of, pressed) - matmul(crushed, beyond)
            face = face + 0.5_wp * (dot_product(pressed, matmul(all_of, pressed)) &
               - dot_product(beyond, matmul(crushed, beyond))) / (stiffer * stiffness)
            ! The mean shares with all corners
            part = stiffer * stiffness * (all_of - crushed)
            gradient = gradient + push(1) / n
            gradient(i) = gradient(i) + push(2)
            gradient(j) = gradient(j) + push(3)
            second = second + part(1, 1) / n**2
            second(:, i) = second(:, i) + part(1, 2) / n
            second(i, :) = second(i, :) + part(1, 2) / n
            second(:, j) = second(:, j) + part(1, 3) / n
            second(j, :) = second(j, :) + part(1, 3) / n
            second(i, i) = second(i, i) + part(2, 2)
            second(j, j) = second(j, j) + part(3, 3)
            second(i, j) = second(i, j) + part(2, 3)
            second(j, i) = second(j, i) + part(2, 3)
         end do
         whole = face + sum((0.5_wp * room%spring * g - room%trial) * g)
      end subroutine evaluate

   end subroutine press_face

   !> Integrals of products of two shape functions of a triangle over the part of it where a linear function is positive [m^2]
   pure function second_moments(value, area) result(moments)
      real(wp), intent(in) :: value(3)           !! at its corners
      real(wp), intent(in) :: area               !! [m^2]
      real(wp) :: moments(3, 3)
      integer :: k
      moments = 0.0_wp
      select case (count(value > 0.0_wp))
      case (0)
         return
      case (1)
         moments = corner_moments(value, area, maxloc(value, dim=1))
         return
      case default
         moments = area / 12.0_wp
         do k = 1, 3
            moments(k, k) = area / 6.0_wp
         end do
      end select
      if (any(value < 0.0_wp)) moments = moments - corner_moments(-value, area, minloc(value, dim=1))
   end function second_moments

   !> The same where the function is positive at one corner alone
   pure function corner_moments(value, area, corner) result(moments)
      real(wp), intent(in) :: value(3)
      real(wp), intent(in) :: area               !! [m^2]
      integer, intent(in) :: corner
      real(wp) :: moments(3, 3)
      real(wp) :: place(3, 3), share(3), total(3)
      integer :: k, l
      ! Shape functions (row) at the corners of the part (column)
      place = 0.0_wp
      do k = 1, 3
         share(k) = value(corner) / (value(corner) - merge(0.0_wp, value(k), k == corner))
         place(k, k) = share(k)
         place(corner, k) = place(corner, k) + 1.0_wp - share(k)
      end do
      total = sum(place, dim=2)
      do k = 1, 3
         do l = 1, 3
            moments(l, k) = area * product(share) / 12.0_wp * (total(l) * total(k) + dot_product(place(l, :), place(k, :)))
         end do
      end do
   end function corner_moments

   !> Solve a symmetric positive definite system by Cholesky's factors
   pure subroutine solve(matrix, right, x)
      real(wp), intent(inout) :: matrix(:, :)    !! the factors are left in it
      real(wp), intent(in) :: right(:)
      real(wp), intent(out) :: x(:)
      integer :: i, j, n
      n = size(right)
      do j = 1, n
         do i = j, n
            matrix(i, j) = matrix(i, j) - dot_product(matrix(i, :j - 1), matrix(j, :j - 1))
            if (i == j) matrix(j, j) = sqrt(max(matrix(j, j), tiny(1.0_wp)))
            if (i > j) matrix(i, j) = matrix(i, j) / matrix(j, j)
         end do
      end do
      do i = 1, n
         x(i) = (right(i) - dot_product(matrix(i, :i - 1), x(:i - 1))) / matrix(i, i)
      end do
      do i = n, 1, -1
         x(i) = (x(i) - dot_product(matrix(i + 1:, i), x(i + 1:))) / matrix(i, i)
      end do
   end subroutine solve

end module dem3_pressure
